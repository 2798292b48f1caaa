#include "param/node_matching.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/creatures.hpp"
#include "core/features.hpp"

namespace crosspatch {
namespace {

struct Nodes {
  TriangleMesh mesh = shapes::creature(3);
  MorseSmaleComplex complex =
      morse_smale_complex(
          mesh, auto_diffusion(compute_spectrum(mesh).value()), {.threshold = 0.005})
          .value();
};

TEST(NodeMatching, TheIdentityMatchesEveryNodeWithItself) {
  const Nodes nodes;
  const Matching matching =
      match_nodes(nodes.mesh, nodes.mesh, nodes.complex, nodes.complex, identity_map(nodes.mesh));
  EXPECT_TRUE(validate(matching, nodes.mesh.vertex_count(), nodes.mesh.vertex_count()));
  EXPECT_EQ(matching.matches.size(), nodes.complex.nodes.size());
  for (const Match& match : matching.matches) {
    EXPECT_EQ(match.source_vertex, match.target_vertex);
    EXPECT_EQ(match.confidence, 1);
  }
}

TEST(NodeMatching, NodesWithoutAnImageOrOutOfReachStayAlone) {
  const Nodes nodes;
  SurfaceMap map = identity_map(nodes.mesh);
  const int unmapped = nodes.complex.nodes[0].vertex;
  map.point_of_source_vertex[static_cast<size_t>(unmapped)] = -1;
  MorseSmaleComplex moved = nodes.complex;
  moved.nodes[1].vertex = moved.nodes.back().vertex;  // a maximum in the minimum's place
  ASSERT_EQ(moved.nodes[1].kind, NodeKind::kMaximum);
  const Matching matching = match_nodes(nodes.mesh, nodes.mesh, nodes.complex, moved, map);
  EXPECT_EQ(matching.matches.size(), nodes.complex.nodes.size() - 2);
  for (const Match& match : matching.matches) {
    EXPECT_NE(match.source_vertex, unmapped);
    EXPECT_EQ(match.source_vertex, match.target_vertex);
  }
}

}  // namespace
}  // namespace crosspatch
