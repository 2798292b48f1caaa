#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/index.hpp"
#include "shapes.hpp"
#include "tools/base64.hpp"
#include "tools/display_mesh.hpp"
#include "tools/verdicts.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

TEST(Base64, IsThatOfTheStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Verdicts, SpeakOfTheFiguresThatThereAre) {
  const auto told = verdicts({{"confidence", 0.5}, {"flipped_triangles", 0}, {"threads", 3}});
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].name, "Confidence");
  EXPECT_EQ(told[0].level, "fair");
  EXPECT_EQ(told[1].level, "good");
  EXPECT_EQ(verdicts({{"flipped_triangles", 1}})[0].level, "poor");
  // What makes a confidence low is told apart.
  const auto crumpled =
      verdicts({{"confidence", 0.5}, {"margin", 0.4}, {"symmetric_dirichlet_99", 200}});
  ASSERT_EQ(crumpled.size(), 3U);
  EXPECT_EQ(crumpled[1].level, "good");
  EXPECT_EQ(crumpled[2].level, "fair");
  EXPECT_EQ(verdicts({{"margin", std::numeric_limits<double>::infinity()}})[0].value,
            "no other map");
}

TEST(DisplayMesh, PlacesAreWhereTheMapComesFrom) {
  const shapes::Surface source = shapes::surface_of(shapes::jittered_grid(shapes::grid(5), 5, 1));
  const shapes::Surface target = shapes::surface_of(shapes::jittered_grid(shapes::grid(6), 6, 2));
  const SurfaceMap map = shapes::planar_overlay(source.prepared.mesh, target.prepared.mesh);
  const auto display =
      display_target(source.view(),
                     target.view(),
                     std::vector<std::uint8_t>(idx(source.prepared.mesh.face_count()), 0),
                     map,
                     0.005);
  ASSERT_TRUE(display) << display.error().message;
  const TexturedMesh& mesh = display->mesh;
  EXPECT_TRUE(mesh.uv_sets.empty());
  for (int c = 0; c < 3 * mesh.triangle_count(); ++c) {
    const Vector3d p = mesh.positions.row(mesh.triangles(c / 3, c % 3)).transpose();
    // Both lie in one plane and the map is the identity of it.
    EXPECT_LT((display->place[idx(c)] - p).norm(), 1e-6);
    EXPECT_LT((position(target.prepared.mesh, display->corner[idx(c)]) - p).norm(), 1e-9);
  }
}

TEST(DisplayMesh, OfTheSourceStaysInPlace) {
  shapes::Surface sphere = shapes::surface_of(shapes::icosphere(1));
  const auto display = display_source(
      sphere.view(), std::vector<std::uint8_t>(idx(sphere.prepared.mesh.face_count()), 7));
  ASSERT_TRUE(display) << display.error().message;
  EXPECT_EQ(display->mesh.triangle_count(), sphere.prepared.mesh.face_count());
  for (const Vector3d& p : display->place) EXPECT_NEAR(p.norm(), 1, 1e-9);
  EXPECT_THAT(display->patch, testing::Each(7));
}

TEST(DisplayMesh, IsCutAlongTheBordersOfPatches) {
  const shapes::Surface source = shapes::surface_of(shapes::jittered_grid(shapes::grid(5), 5, 1));
  const shapes::Surface target = shapes::surface_of(shapes::jittered_grid(shapes::grid(3), 3, 2));
  const TriangleMesh& mesh = source.prepared.mesh;
  std::vector<std::uint8_t> patch;
  std::array<double, 3> area{}, carried{};
  const Eigen::VectorXd areas = face_areas(mesh);
  for (int f = 0; f < mesh.face_count(); ++f) {
    patch.push_back(static_cast<std::uint8_t>(f % 3));
    area[idx(f % 3)] += areas[f];
  }
  const SurfaceMap map = shapes::planar_overlay(mesh, target.prepared.mesh);
  const auto display = display_target(source.view(), target.view(), patch, map, 0.005);
  ASSERT_TRUE(display) << display.error().message;
  ASSERT_EQ(idx(display->mesh.triangle_count()), display->patch.size());
  for (int t = 0; t < display->mesh.triangle_count(); ++t) {
    ASSERT_LT(display->patch[idx(t)], 3);
    const auto p = [&](int k) -> Vector3d {
      return display->mesh.positions.row(display->mesh.triangles(t, k)).transpose();
    };
    carried[display->patch[idx(t)]] += (p(1) - p(0)).cross(p(2) - p(0)).norm() / 2;
  }
  // The map is the identity of the plane: each patch keeps its area.
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(carried[k], area[k], 1e-6);
}

}  // namespace
}  // namespace crosspatch
