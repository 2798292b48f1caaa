#include "transfer/bake.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "shapes.hpp"
#include "transfer/atlas.hpp"
#include "transfer/painted.hpp"
#include "transfer/texture_pyramid.hpp"

namespace crosspatch {
namespace {

using shapes::Surface;

RasterImage image_of(const TexturedMesh& mesh, const TextureRef& ref) {
  const auto image = decode_image_file(mesh.images[idx(ref.image)].bytes);
  EXPECT_TRUE(image) << image.error().message;
  return *image;
}

Eigen::Array3d value(const RasterImage& image, int x, int y) {
  const std::size_t i = (idx(y) * idx(image.width) + idx(x)) * idx(image.channels);
  return Eigen::Array3d(image.values[i], image.values[i + 1], image.values[i + 2]) / 65535;
}

/// Smooth in space, with every colour in it.
Vector3d waves(const Vector3d& p) {
  return (Vector3d(std::sin(5 * p[0]), std::sin(4 * p[1] + 1), std::sin(6 * p[2] + 2)) * 0.4 +
          Vector3d::Constant(0.5));
}

/// A planar surface over the unit square with UVs given by place.
Surface plane(int n, unsigned seed, const std::function<Vector2d(const Vector2d&)>& uv) {
  Surface s = shapes::surface_of(shapes::jittered_grid(shapes::grid(n), n, seed));
  shapes::texture(
      s, [&](int, const Vector3d& p) { return uv(p.head<2>()); }, 64);
  return s;
}

Vector2d upright(const Vector2d& p) {
  return {0.1 + 0.8 * p[0], 0.9 - 0.8 * p[1]};
}

/// u runs along +y, v along +x: a quarter turn against `upright`.
Vector2d quarter_turned(const Vector2d& p) {
  return {0.1 + 0.8 * p[1], 0.1 + 0.8 * p[0]};
}

struct PlanarPair {
  Surface source, target;
  SurfaceMap map;
};

PlanarPair planar_pair(const std::function<Vector2d(const Vector2d&)>& source_uv) {
  PlanarPair pair{plane(5, 1, source_uv), plane(6, 2, upright), {}};
  pair.map = shapes::planar_overlay(pair.source.prepared.mesh, pair.target.prepared.mesh);
  return pair;
}

TEST(Bake, SameSurfaceKeepsItsLook) {
  Surface source = shapes::surface_of(shapes::icosphere(3));
  const TriangleMesh& mesh = source.prepared.mesh;
  const auto atlas = make_atlas(mesh, {.size = 512});
  ASSERT_TRUE(atlas) << atlas.error().message;
  shapes::paint(source, atlas->unwrap, 512, waves);
  const Surface target = shapes::surface_of(mesh);
  const auto baked = bake_texture(source.view(), target.view(), identity_map(mesh), {.size = 1024});
  ASSERT_TRUE(baked) << baked.error().message;
  EXPECT_FALSE(baked->statistics.own_unwrap);
  EXPECT_EQ(baked->statistics.texels_filled, 1);
  EXPECT_NEAR(baked->statistics.coverage, 1, 1e-12);
  for (int level = 0; level < 4; ++level)
    EXPECT_LE(baked->statistics.seam_error[idx(level)], 4) << "mip " << level;

  const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].base_color);
  const TexturePyramid pyramid = make_pyramid(image, ColorSpace::kSrgb, false);
  std::mt19937 random(0);
  std::uniform_real_distribution<double> unit(0, 1);
  double squares = 0;
  constexpr int kPoints = 20000;
  for (int i = 0; i < kPoints; ++i) {
    const int f = static_cast<int>(random() % static_cast<unsigned>(mesh.face_count()));
    const double s = std::sqrt(unit(random)), t = unit(random);
    const SurfacePoint p{f, Vector3d(1 - s, s * (1 - t), s * t)};
    Vector2d uv = Vector2d::Zero();
    for (int k = 0; k < 3; ++k) uv += p.bary[k] * baked->mesh.uv_sets[0][idx(3 * f + k)];
    const auto read = sample(pyramid.levels[0], {}, uv.cast<float>());
    const Vector3d truth = waves(position(mesh, p));
    squares += (read.head<3>().cast<double>().matrix() - truth).squaredNorm() / 3;
  }
  EXPECT_GE(-10 * std::log10(squares / kPoints), 35);  // dB
}

TEST(Bake, FillsTheTargetsOwnUnwrapThroughTheMap) {
  PlanarPair pair = planar_pair(upright);
  pair.source.soup.images = {
      shapes::png(64, 3, [](double u, double v) { return Eigen::Array4d(u, v, 0.5, 1); })};
  const auto baked = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 64});
  ASSERT_TRUE(baked) << baked.error().message;
  EXPECT_TRUE(baked->statistics.own_unwrap);
  EXPECT_EQ(baked->statistics.texels_filled, 1);
  EXPECT_NEAR(baked->statistics.density_ratio[0], 1, 1e-9);
  EXPECT_EQ(baked->mesh.triangle_count(), pair.target.prepared.mesh.face_count());
  const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].base_color);
  // The unwrap covers [0.1, 0.9]; both surfaces have the same UVs there, so texels stay what they
  // were, up to rounding to 8 bits and back.
  for (int y = 8; y < 56; ++y)
    for (int x = 8; x < 56; ++x) {
      const Eigen::Array3d expected((x + 0.5) / 64, (y + 0.5) / 64, 0.5);
      EXPECT_LE((value(image, x, y) - expected).abs().maxCoeff(), 1.01 / 255) << x << ' ' << y;
    }
}

TEST(Bake, FlatNormalMapsStayFlatAndTurnedOnesTurn) {
  struct Case {
    Vector3d stored, expected;
  };
  // In the source's frame x is along +y of the plane. The bitangent, against growing v, is along
  // -x. In the target's frame x is along +x, y along +y.
  for (const Case& c : {Case{{0, 0, 1}, {0, 0, 1}},
                        Case{{0.6, 0, 0.8}, {0, 0.6, 0.8}},
                        Case{{0, 0.6, 0.8}, {-0.6, 0, 0.8}}}) {
    PlanarPair pair = planar_pair(quarter_turned);
    pair.source.soup.images = {shapes::png(64, 3, [&](double, double) {
      return Eigen::Array4d(c.stored[0] / 2 + 0.5, c.stored[1] / 2 + 0.5, c.stored[2] / 2 + 0.5, 1);
    })};
    pair.source.soup.materials[0].base_color = {};
    pair.source.soup.materials[0].normal.image = 0;
    const auto baked = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 64});
    ASSERT_TRUE(baked) << baked.error().message;
    const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].normal);
    for (int y = 8; y < 56; ++y)
      for (int x = 8; x < 56; ++x) {
        const Eigen::Array3d n = value(image, x, y) * 2 - 1;
        // One step of 8 bits is 2 / 255; the stored map and the baked one are each off by half.
        EXPECT_LE((n - c.expected.array()).abs().maxCoeff(), 2.0 / 255) << x << ' ' << y;
        EXPECT_NEAR(n.matrix().norm(), 1, 2.0 / 255);
      }
  }
}

TEST(Bake, TransparentTexelsDoNotBleed) {
  PlanarPair pair = planar_pair(upright);
  // Green and transparent on the left, red and opaque on the right.
  pair.source.soup.images = {shapes::png(64, 4, [](double u, double) {
    return u < 0.5 ? Eigen::Array4d(0, 1, 0, 0) : Eigen::Array4d(1, 0, 0, 1);
  })};
  pair.source.soup.materials[0].alpha_mode = "BLEND";
  const auto baked = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 48});
  ASSERT_TRUE(baked) << baked.error().message;
  EXPECT_EQ(baked->mesh.materials[0].alpha_mode, "BLEND");
  const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].base_color);
  ASSERT_EQ(image.channels, 4);
  for (std::size_t i = 0; i < image.values.size(); i += 4)
    if (image.values[i + 3] > 0) {
      EXPECT_LE(image.values[i + 1], 257) << i;  // no green where seen
    }
}

TEST(Bake, FactorsAndVertexColorsArePaintedIn) {
  PlanarPair pair = planar_pair(upright);
  pair.source.soup.images.clear();
  Material& m = pair.source.soup.materials[0];
  m.base_color = {};
  m.base_color_factor = {0.5, 1, 1, 1};
  pair.source.soup.corner_colors.assign(pair.source.soup.corner_vertex.size(), {1, 0.25F, 0, 1});
  const auto baked = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 32});
  ASSERT_TRUE(baked) << baked.error().message;
  const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].base_color);
  const auto linear = [&](std::size_t k) {
    return to_linear_light(image.values[k], ColorSpace::kSrgb);
  };
  EXPECT_NEAR(linear(0), 0.5, 0.005);
  EXPECT_NEAR(linear(1), 0.25, 0.005);
  EXPECT_NEAR(linear(2), 0, 0.005);
  EXPECT_EQ(baked->mesh.materials[0].base_color_factor, (std::array<double, 4>{1, 1, 1, 1}));
}

TEST(Bake, PlacesWithoutAMapAreGrey) {
  PlanarPair pair = planar_pair(upright);
  pair.source.soup.images = {
      shapes::png(16, 3, [](double, double) { return Eigen::Array4d(1, 0, 0, 1); })};
  // A map of the first half of the polygons only.
  SurfaceMap part = pair.map;
  const int polygons = part.polygon_count() / 2;
  part.polygon_begin.resize(idx(polygons + 1));
  part.corner.resize(idx(part.polygon_begin.back()));
  part.source_face.resize(idx(polygons));
  part.target_face.resize(idx(polygons));
  const auto baked = bake_texture(pair.source.view(), pair.target.view(), part, {.size = 64});
  ASSERT_TRUE(baked) << baked.error().message;
  EXPECT_LT(baked->statistics.coverage, 0.9);
  EXPECT_GT(baked->statistics.coverage, 0.01);
  EXPECT_EQ(baked->statistics.texels_filled, 1);
}

TEST(Bake, RefusesBadOptionsAndImages) {
  PlanarPair pair = planar_pair(upright);
  const auto small = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 8});
  ASSERT_FALSE(small);
  EXPECT_EQ(small.error().message, "image size 8 is outside [16, 16384]");
  // Only a header: the image cannot be decoded.
  const auto broken = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 64});
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(broken.error().message, testing::HasSubstr("texture.png"));
}

}  // namespace
}  // namespace crosspatch
