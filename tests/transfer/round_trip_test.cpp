#include "transfer/round_trip.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"
#include "transfer/atlas.hpp"
#include "transfer/painted.hpp"

namespace crosspatch {
namespace {

using shapes::Surface;

/// A sphere painted with waves, `frequency` to a unit of length.
Surface painted_sphere(double frequency) {
  Surface s = shapes::surface_of(shapes::icosphere(3));
  const Unwrap unwrap = make_atlas(s.prepared.mesh, {.size = 512}).value().unwrap;
  shapes::paint(s, unwrap, 512, [&](const Vector3d& p) {
    return Vector3d((p * frequency).array().sin() * 0.4 + 0.5);
  });
  return s;
}

RoundTrip there_and_back(const Surface& source, int size) {
  const TriangleMesh& mesh = source.prepared.mesh;
  const Surface target = shapes::surface_of(mesh);
  const SurfaceMap map = identity_map(mesh);
  const auto baked = bake_texture(source.view(), target.view(), map, {.size = size});
  EXPECT_TRUE(baked) << baked.error().message;
  const auto trip = round_trip(source.view(), target.view(), map, baked->mesh);
  EXPECT_TRUE(trip) << trip.error().message;
  return *trip;
}

TEST(RoundTrip, OfAFineImageLosesLittleAndOfACoarseOneMuch) {
  const Surface source = painted_sphere(20);
  const RoundTrip fine = there_and_back(source, 1024);
  EXPECT_EQ(fine.size, 512);
  EXPECT_NEAR(fine.covered, 1, 1e-12);
  EXPECT_GE(fine.similarity.psnr, 40);
  EXPECT_GE(fine.similarity.ssim, 0.99);
  const RoundTrip coarse = there_and_back(source, 64);
  EXPECT_LT(coarse.similarity.psnr, 25);
  EXPECT_LT(coarse.similarity.ssim, 0.9);
}

TEST(RoundTrip, LeavesOutWhatIsNotMapped) {
  const Surface source = painted_sphere(5);
  const TriangleMesh& mesh = source.prepared.mesh;
  const Surface target = shapes::surface_of(mesh);
  SurfaceMap half = identity_map(mesh);
  const int polygons = half.polygon_count() / 2;
  half.polygon_begin.resize(idx(polygons + 1));
  half.corner.resize(idx(half.polygon_begin.back()));
  half.source_face.resize(idx(polygons));
  half.target_face.resize(idx(polygons));
  const auto baked = bake_texture(source.view(), target.view(), half, {.size = 512});
  ASSERT_TRUE(baked) << baked.error().message;
  const auto trip = round_trip(source.view(), target.view(), half, baked->mesh);
  ASSERT_TRUE(trip) << trip.error().message;
  EXPECT_NEAR(trip->covered, 0.5, 0.05);
  EXPECT_GE(trip->similarity.psnr, 35);  // grey texels beside the border are filtered in
}

TEST(RoundTrip, NeedsAnUnwrapOfTheSource) {
  const Surface source = painted_sphere(5);
  const TriangleMesh& mesh = source.prepared.mesh;
  const Surface target = shapes::surface_of(mesh);
  const SurfaceMap map = identity_map(mesh);
  const auto baked = bake_texture(source.view(), target.view(), map, {.size = 64});
  ASSERT_TRUE(baked);
  Surface tiled = source;
  for (Vector2d& uv : tiled.soup.uv_sets[0]) uv *= 2;
  const auto trip = round_trip(tiled.view(), target.view(), map, baked->mesh);
  ASSERT_FALSE(trip);
  EXPECT_NE(trip.error().message.find("is outside of [0, 1]"), std::string::npos);
}

}  // namespace
}  // namespace crosspatch
