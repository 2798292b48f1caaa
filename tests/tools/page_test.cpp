#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  const auto told = verdicts({{"margin", 0.05}, {"flipped_triangles", 0}, {"threads", 3}});
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].name, "Confidence");
  EXPECT_EQ(told[0].level, "fair");
  EXPECT_EQ(told[1].level, "good");
  EXPECT_EQ(verdicts({{"flipped_triangles", 1}})[0].level, "poor");
}

TEST(DisplayMesh, PlacesAreWhereTheMapComesFrom) {
  const shapes::Surface source = shapes::surface_of(shapes::jittered_grid(shapes::grid(5), 5, 1));
  const shapes::Surface target = shapes::surface_of(shapes::jittered_grid(shapes::grid(6), 6, 2));
  const SurfaceMap map = shapes::planar_overlay(source.prepared.mesh, target.prepared.mesh);
  const auto display = display_target(source.view(), target.view(), map, 0.005);
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
  const auto display = display_source(sphere.view());
  ASSERT_TRUE(display) << display.error().message;
  EXPECT_EQ(display->mesh.triangle_count(), sphere.prepared.mesh.face_count());
  for (const Vector3d& p : display->place) EXPECT_NEAR(p.norm(), 1, 1e-9);
}

}  // namespace
}  // namespace crosspatch
