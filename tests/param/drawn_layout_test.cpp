#include "param/drawn_layout.hpp"

#include <gtest/gtest.h>

#include "core/morse_fields.hpp"

namespace crosspatch {
namespace {

DiscreteGradient simplified(const TriangleMesh& mesh, const Eigen::VectorXd& values, double level) {
  auto gradient = discrete_gradient(mesh, values).value();
  const auto hierarchy = persistence_hierarchy(gradient, FieldScale::kLinear).value();
  return simplify(std::move(gradient), hierarchy, level);
}

TEST(DrawnLayout, IsValidOnClosedFieldsAtAllLevels) {
  int drawn_count = 0;
  for (const shapes::Field& field : shapes::morse_fields()) {
    if (!boundary_loops(field.mesh).empty()) continue;
    for (const double level : {0.0, 0.02, 0.1, 0.3, 0.6}) {
      const DiscreteGradient gradient = simplified(field.mesh, field.values, level);
      const auto layout = quad_layout(gradient);
      if (!layout) continue;
      const auto drawn = draw_layout(*layout, gradient);
      ASSERT_TRUE(drawn) << field.name << " at " << level << ": " << drawn.error().message;
      const Status valid = validate(*drawn);
      EXPECT_TRUE(valid) << field.name << " at " << level << ": " << valid.error().message;
      ++drawn_count;
    }
  }
  EXPECT_GT(drawn_count, 30);
}

TEST(DrawnLayout, RefinesTheSurfaceWithoutMovingIt) {
  const TriangleMesh mesh = shapes::torus(3, 1, 30, 16);
  const DiscreteGradient gradient = simplified(mesh, shapes::noise(mesh, 3), 0.3);
  const DrawnLayout drawn = draw_layout(quad_layout(gradient).value(), gradient).value();
  EXPECT_NEAR(total_area(drawn.mesh), total_area(mesh), 1e-12 * total_area(mesh));
  EXPECT_EQ(drawn.mesh.V.topRows(mesh.vertex_count()), mesh.V);
  EXPECT_GT(face_areas(drawn.mesh).minCoeff(), 0);
  for (int v = 0; v < drawn.mesh.vertex_count(); ++v)
    EXPECT_LT(
        (position(mesh, drawn.origin[static_cast<size_t>(v)]) - drawn.mesh.position(v)).norm(),
        1e-14);
  const Eigen::VectorXd areas = face_areas(drawn.mesh), parents = face_areas(mesh);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(mesh.face_count());
  for (int f = 0; f < drawn.mesh.face_count(); ++f)
    sums[drawn.parent_face[static_cast<size_t>(f)]] += areas[f];
  EXPECT_LT((sums - parents).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(DrawnLayout, SurfacesWithBoundaryAreRefused) {
  const TriangleMesh mesh = shapes::grid(12);
  const DiscreteGradient gradient = simplified(mesh, shapes::noise(mesh, 1), 0);
  EXPECT_EQ(draw_layout(quad_layout(gradient).value(), gradient).error().code,
            ErrorCode::kBadInput);
}

}  // namespace
}  // namespace crosspatch
