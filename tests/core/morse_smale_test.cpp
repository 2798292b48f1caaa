#include "core/morse_smale.hpp"

#include <gtest/gtest.h>

#include "core/morse_fields.hpp"

namespace crosspatch {
namespace {

TEST(MorseSmale, IsValidOnAllFieldsAndLevels) {
  for (const shapes::Field& field : shapes::morse_fields())
    for (const double threshold : {0.0, 0.02, 0.2, 2.0}) {
      const auto complex =
          morse_smale_complex(field.mesh, field.values, {.threshold = threshold}).value();
      const Status valid = validate(complex, shapes::closed_euler(field.mesh));
      EXPECT_TRUE(valid) << field.name << " at " << threshold << ": " << valid.error().message;
    }
}

TEST(MorseSmale, PathsRunAlongMeshEdgesBetweenTheirNodes) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    if (!boundary_loops(field.mesh).empty()) continue;  // cones may be crossed there
    const auto complex = morse_smale_complex(field.mesh, field.values).value();
    for (const MorseArc& arc : complex.arcs) {
      EXPECT_EQ(arc.path.front(), complex.nodes[static_cast<size_t>(arc.saddle)].vertex);
      EXPECT_EQ(arc.path.back(), complex.nodes[static_cast<size_t>(arc.extremum)].vertex);
      for (size_t i = 1; i < arc.path.size(); ++i)
        EXPECT_GE(find_halfedge(field.mesh, arc.path[i - 1], arc.path[i]), 0) << field.name;
    }
  }
}

TEST(MorseSmale, HeightOfALyingTorusHasFourCriticalPoints) {
  const TriangleMesh mesh = shapes::torus(3, 1, 40, 20);
  const auto complex = morse_smale_complex(mesh, mesh.V.col(0), {.scale = FieldScale::kLinear});
  ASSERT_TRUE(complex);
  ASSERT_EQ(complex->nodes.size(), 4u);
  const double expected[] = {4, 2, -2, -4};  // outermost and innermost points of the two sides
  for (size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(complex->nodes[i].value, expected[i], 0.05);  // mesh resolution
}

TEST(MorseSmale, NegationExchangesMinimaAndMaxima) {
  const TriangleMesh mesh = shapes::icosphere(3);
  const Eigen::VectorXd values =
      (4 * mesh.V.col(0).array()).sin() + (5 * mesh.V.col(1).array() + mesh.V.col(2).array()).cos();
  const MorseSmaleOptions options{.threshold = 0.1, .scale = FieldScale::kLinear};
  const auto up = morse_smale_complex(mesh, values, options).value();
  const auto down = morse_smale_complex(mesh, -values, options).value();
  EXPECT_GT(up.count(NodeKind::kSaddle), 2);
  EXPECT_EQ(up.count(NodeKind::kMinimum), down.count(NodeKind::kMaximum));
  EXPECT_EQ(up.count(NodeKind::kMaximum), down.count(NodeKind::kMinimum));
}

TEST(MorseSmale, BoundaryMaximaStayNodes) {
  // The height of a sheet: its highest corner is a maximum although it lies on the boundary.
  const TriangleMesh mesh = shapes::grid(6);
  const auto complex = morse_smale_complex(
      mesh, mesh.V.col(0) + 0.5 * mesh.V.col(1), {.scale = FieldScale::kLinear});
  ASSERT_TRUE(complex);
  EXPECT_EQ(complex->count(NodeKind::kMaximum), 1);
  EXPECT_EQ(complex->nodes[0].vertex, mesh.vertex_count() - 1);
}

}  // namespace
}  // namespace crosspatch
