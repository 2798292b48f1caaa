#pragma once

#include <gtest/gtest.h>

#include "param/match.hpp"

namespace crosspatch {

/// Every vertex is mapped, the map covers both surfaces once, and it satisfies its invariants.
inline void expect_whole(const MatchedMap& matched,
                         const TriangleMesh& source,
                         const TriangleMesh& target) {
  const MapResult& result = matched.result;
  const Status valid = validate(result.map, source, target);
  EXPECT_TRUE(valid) << valid.error().message;
  EXPECT_NEAR(result.quality.source_coverage, 1, 1e-9);
  EXPECT_NEAR(result.quality.target_coverage, 1, 1e-9);
  EXPECT_EQ(result.quality.flipped, 0);
  const auto expect_at_vertices = [](const TriangleMesh& mesh,
                                     const std::vector<SurfacePoint>& points,
                                     const std::vector<int>& point_of_vertex) {
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      const int q = point_of_vertex[static_cast<std::size_t>(v)];
      ASSERT_GE(q, 0) << "vertex " << v;
      EXPECT_LT((position(mesh, points[static_cast<std::size_t>(q)]) - mesh.position(v)).norm(),
                1e-9);
    }
  };
  expect_at_vertices(source, result.map.source, result.map.point_of_source_vertex);
  expect_at_vertices(target, result.map.target, result.map.point_of_target_vertex);
}

}  // namespace crosspatch
