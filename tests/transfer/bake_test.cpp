#include "transfer/bake.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "shapes.hpp"
#include "transfer/atlas.hpp"
#include "transfer/painted.hpp"
#include "transfer/tangents.hpp"
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
  const TexturePyramid pyramid = make_pyramid(image, ColorSpace::kSrgb, Alpha::kIgnored);
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

/// The normal in space that a renderer makes of a normal map at a point of a face.
Vector3d lit_normal(const TexturedMesh& mesh,
                    const std::vector<Eigen::Vector4d>& tangents,
                    const TexturePyramid& map,
                    const SurfacePoint& p) {
  Vector3d normal = Vector3d::Zero();
  Eigen::Vector4d tangent = Eigen::Vector4d::Zero();
  Vector2d uv = Vector2d::Zero();
  for (int k = 0; k < 3; ++k) {
    const std::size_t corner = idx(3 * p.face + k);
    normal += p.bary[k] * shading_normal(mesh, p.face, k);
    tangent += p.bary[k] * tangents[corner];
    uv += p.bary[k] * mesh.uv_sets[0][corner];
  }
  normal.normalize();
  const Vector3d t = (tangent.head<3>() - normal * normal.dot(tangent.head<3>())).normalized();
  const Vector3d b = (tangent[3] < 0 ? -1 : 1) * normal.cross(t);
  const Vector3d n = sample(map.levels[0], {}, uv.cast<float>()).head<3>().cast<double>() * 2 - 1;
  return (t * n[0] + b * n[1] + normal * n[2]).normalized();
}

TEST(Bake, BumpyNormalMapsLightTheSameInTurnedAndMirroredFrames) {
  const TriangleMesh mesh = shapes::icosphere(3);
  const Unwrap unwrap = make_atlas(mesh, {.size = 512}).value().unwrap;
  Surface source = shapes::surface_of(mesh);
  shapes::texture(
      source, [](int, const Vector3d&) { return Vector2d::Zero(); }, 1024);
  source.soup.uv_sets[0] = unwrap.uv;
  source.soup.materials[0].base_color = {};
  source.soup.materials[0].normal.image = 0;
  source.soup.images = {shapes::png(1024, 3, [](double u, double v) {
    const Vector3d n = Vector3d(0.6 * std::sin(50 * u), 0.6 * std::cos(40 * v), 1).normalized();
    return Eigen::Array4d(n[0] / 2 + 0.5, n[1] / 2 + 0.5, n[2] / 2 + 0.5, 1);
  })};
  const auto turned = [](const Vector2d& uv) { return Vector2d(1 - uv[1], uv[0]); };
  const auto mirrored = [](const Vector2d& uv) { return Vector2d(uv[1], uv[0]); };
  for (const auto& change :
       std::vector<std::function<Vector2d(const Vector2d&)>>{turned, mirrored}) {
    Surface target = shapes::surface_of(mesh);
    target.soup.uv_sets.emplace_back();
    for (const Vector2d& uv : unwrap.uv) target.soup.uv_sets[0].push_back(change(uv));
    const auto baked =
        bake_texture(source.view(), target.view(), identity_map(mesh), {.size = 1024});
    ASSERT_TRUE(baked) << baked.error().message;
    ASSERT_TRUE(baked->statistics.own_unwrap) << baked->statistics.why_not_own;
    const auto pyramid = [](const RasterImage& image) {
      return make_pyramid(image, ColorSpace::kLinear, Alpha::kIgnored);
    };
    const TexturePyramid before = pyramid(*decode_image_file(source.soup.images[0].bytes));
    const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].normal);
    const TexturePyramid after = pyramid(image);
    for (std::size_t i = 0; i < image.values.size(); i += 3) {
      const Vector3d n =
          Vector3d(image.values[i], image.values[i + 1], image.values[i + 2]) / 32767.5;
      ASSERT_NEAR((n - Vector3d::Ones()).norm(), 1, 2.0 / 255) << i;  // rounding to 8 bits
    }
    TexturedMesh original = baked->mesh;
    original.uv_sets[0] = unwrap.uv;
    const auto tangents_before = corner_tangents(original, 0, 0);
    const auto tangents_after = corner_tangents(baked->mesh, 0, 0);
    std::mt19937 random(0);
    std::uniform_real_distribution<double> unit(0, 1);
    double degrees = 0, relief = 0;
    constexpr int kPoints = 5000;
    for (int i = 0; i < kPoints; ++i) {
      const int f = static_cast<int>(random() % static_cast<unsigned>(mesh.face_count()));
      const double s = std::sqrt(unit(random)), t = unit(random);
      const SurfacePoint p{f, Vector3d(1 - s, s * (1 - t), s * t)};
      const Vector3d a = lit_normal(original, tangents_before, before, p);
      const Vector3d b = lit_normal(baked->mesh, tangents_after, after, p);
      const auto angle = [](const Vector3d& x, const Vector3d& y) {
        return std::acos(std::clamp(x.dot(y), -1.0, 1.0)) * 180 / 3.14159265358979;
      };
      degrees += angle(a, b) / kPoints;
      relief += angle(a, position(mesh, p).normalized()) / kPoints;
    }
    EXPECT_LE(degrees, 3);
    EXPECT_GE(relief, 20);  // the bumps are large against what is allowed
  }
}

TEST(Bake, ColoursAreAveragedAsLightAndDataAsNumbers) {
  PlanarPair pair = planar_pair(upright);
  pair.source.soup.images = {shapes::png(64, 3, [](double u, double) {
    return static_cast<int>(u * 64) % 2 == 0 ? Eigen::Array4d(0, 0, 0, 1)
                                             : Eigen::Array4d(1, 1, 1, 1);
  })};
  Material& m = pair.source.soup.materials[0];
  m.emissive = m.occlusion = m.metallic_roughness = m.base_color;
  m.emissive_factor = {1, 1, 1};
  m.metallic_factor = m.roughness_factor = 1;
  const auto baked = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 32});
  ASSERT_TRUE(baked) << baked.error().message;
  const Material& out = baked->mesh.materials[0];
  // Half of the light is 188 of 255 in sRGB (IEC 61966-2-1), half of a number 128.
  for (const TextureRef* color : {&out.base_color, &out.emissive})
    EXPECT_NEAR(value(image_of(baked->mesh, *color), 16, 16)[0], 188.0 / 255, 1.0 / 255);
  for (const TextureRef* data : {&out.occlusion, &out.metallic_roughness})
    EXPECT_NEAR(value(image_of(baked->mesh, *data), 16, 16)[1], 128.0 / 255, 1.0 / 255);
}

TEST(Bake, SixteenBitsStaySixteenBits) {
  PlanarPair pair = planar_pair(upright);
  RasterImage ramp{64, 64, 3, {}};
  const auto at = [](int x, int y) {
    return static_cast<std::uint16_t>(20000 + 10 * (64 * y + x));
  };
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) ramp.values.insert(ramp.values.end(), 3, at(x, y));
  pair.source.soup.images = {
      image_file("ramp", ImageFormat::kPng, *encode_image_file(ramp, {.bits = 16}))};
  const auto baked = bake_texture(
      pair.source.view(), pair.target.view(), pair.map, {.size = 64, .encoding = {.bits = 16}});
  ASSERT_TRUE(baked) << baked.error().message;
  const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].base_color);
  // One step of linear light is up to five of sRGB at these values; a step of 8 bits is 257.
  for (int y = 8; y < 56; ++y)
    for (int x = 8; x < 56; ++x)
      EXPECT_NEAR(value(image, x, y)[0] * 65535, at(x, y), 16) << x << ' ' << y;
}

TEST(Bake, WhatLiesBetweenTheIslandsOfATextureDoesNotBleed) {
  // A grey island on red, baked with texels as large as several of the source's.
  const auto inside = [](double x) { return x > 0.1 && x < 0.9; };
  PlanarPair pair = planar_pair(upright);
  pair.source.soup.images = {shapes::png(160, 3, [&](double u, double v) {
    return inside(u) && inside(v) ? Eigen::Array4d(0.5, 0.5, 0.5, 1) : Eigen::Array4d(1, 0, 0, 1);
  })};
  const auto baked = bake_texture(pair.source.view(), pair.target.view(), pair.map, {.size = 24});
  ASSERT_TRUE(baked) << baked.error().message;
  const RasterImage image = image_of(baked->mesh, baked->mesh.materials[0].base_color);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x)
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(value(image, x, y)[k], 128 / 255.0, 1.01 / 255);
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
