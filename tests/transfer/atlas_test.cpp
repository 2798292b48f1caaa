#include "transfer/atlas.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/index.hpp"
#include "shapes.hpp"
#include "transfer/surfaces.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

void expect_atlas(const TriangleMesh& mesh) {
  const auto atlas = make_atlas(mesh, {.size = 512});
  ASSERT_TRUE(atlas) << atlas.error().message;
  ASSERT_EQ(atlas->unwrap.uv.size(), idx(mesh.halfedge_count()));
  EXPECT_EQ(overlap(atlas->unwrap, {}, 2048), 0);
  EXPECT_GT(atlas->used, 0.3);
  double area = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto corner = in_texels(atlas->unwrap, f, 1);
    for (const Vector2d& p : corner) {
      EXPECT_GE(p.minCoeff(), 0);
      EXPECT_LE(p.maxCoeff(), 1);
    }
    // v runs downwards: seen from outside a face is clockwise in numbers.
    const double doubled = doubled_area(corner[0], corner[1], corner[2]);
    EXPECT_LT(doubled, 0) << f;
    area -= doubled / 2;
  }
  EXPECT_NEAR(area, atlas->used, 1e-9);
}

TEST(Atlas, ChartsOfSpheresToriAndPlanesNeitherOverlapNorTurn) {
  expect_atlas(shapes::icosphere(3));
  expect_atlas(shapes::torus(1, 0.3, 24, 12));
  expect_atlas(shapes::grid(5));
  expect_atlas(shapes::tetrahedron());
}

TEST(Atlas, EveryPartGetsTexelsByItsArea) {
  const TriangleMesh mesh = shapes::torus(1, 0.3, 48, 24);
  const auto atlas = make_atlas(mesh, {.size = 512});
  ASSERT_TRUE(atlas) << atlas.error().message;
  const Eigen::VectorXd areas = face_areas(mesh);
  const double scale = atlas->used / areas.sum();
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto c = in_texels(atlas->unwrap, f, 1);
    const double ratio = -doubled_area(c[0], c[1], c[2]) / 2 / areas[f] / scale;
    // Strips of a torus bend both ways, which costs some area; a factor of two in length is 4.
    EXPECT_GT(ratio, 0.25) << f;
    EXPECT_LT(ratio, 4) << f;
  }
}

/// A sphere with limbs and dents at random.
TriangleMesh bumpy(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  TriangleMesh mesh = shapes::icosphere(4);
  const MatrixX3d X = mesh.V;
  for (int bump = 0; bump < 12; ++bump) {
    const double size = 0.7 + unit(random);
    Vector3d axis;
    for (double& x : axis) x = unit(random);
    axis.normalize();
    for (int v = 0; v < mesh.vertex_count(); ++v)
      mesh.V.row(v) += size * std::exp(-25 * (1 - X.row(v).dot(axis.transpose()))) * X.row(v);
  }
  return mesh;
}

TEST(Atlas, GivesNoTexelToTwoPlaces) {
  // The charts of seeds 4 and 23 cross themselves by a few texels before they are cut further.
  for (const unsigned seed : {0U, 4U, 23U}) {
    const auto atlas = make_atlas(bumpy(seed));
    ASSERT_TRUE(atlas) << atlas.error().message;
    EXPECT_EQ(overlap(atlas->unwrap, {}, AtlasOptions{}.size), 0) << "seed " << seed;
  }
}

TEST(Unwrap, OfTheFileServesOnlyWhereItIsOne) {
  const TriangleMesh mesh = shapes::grid(4);
  const auto with = [&](const std::function<Vector2d(int, const Vector3d&)>& uv) {
    shapes::Surface s = shapes::surface_of(mesh);
    shapes::texture(s, uv, 16);
    return own_unwrap(s.view());
  };
  EXPECT_TRUE(with([](int, const Vector3d& p) { return Vector2d(p[0], p[1]); }));
  const auto message = [](const Result<Unwrap>& unwrap) {
    return unwrap ? std::string("none") : unwrap.error().message;
  };
  EXPECT_THAT(message(with([](int, const Vector3d& p) { return Vector2d(2 * p[0], p[1]); })),
              testing::HasSubstr("outside of [0, 1]"));
  EXPECT_THAT(message(with([](int, const Vector3d& p) { return Vector2d(p[0], 0.5); })),
              testing::HasSubstr("no extent"));
  EXPECT_THAT(
      message(with([](int, const Vector3d& p) { return Vector2d(std::abs(p[0] - 0.5), p[1]); })),
      testing::HasSubstr("several places"));
  EXPECT_THAT(message(own_unwrap(shapes::surface_of(mesh).view())),
              testing::HasSubstr("no texture coordinates"));
}

TEST(Unwrap, FoldsAreMeasuredOnTheSurface) {
  const TriangleMesh mesh = shapes::grid(4);
  // The last of four columns is folded back, and pressed together so that it has hardly a texel.
  const auto folded = [&](double sign) {
    Unwrap unwrap;
    for (int h = 0; h < mesh.halfedge_count(); ++h) {
      const Vector3d p = mesh.position(mesh.from(h));
      const double x = p[0] > 0.75 + 1e-9 ? 0.75 - 1e-4 : p[0];
      unwrap.uv.emplace_back(0.5 + sign * (x - 0.5), p[1]);
    }
    return folded_share(mesh, unwrap);
  };
  EXPECT_NEAR(folded(1), 0.25, 1e-12);
  EXPECT_NEAR(folded(-1), 0.25, 1e-12);
  // A chart that is turned over as a whole lies on nothing.
  Unwrap apart;
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const Vector3d p = mesh.position(mesh.from(h));
    double x = 0;
    for (int k = 0; k < 3; ++k) x += mesh.V(mesh.F(face_of(h), k), 0) / 3;
    apart.uv.emplace_back(x > 0.5 ? 1.5 - p[0] : p[0] / 2, p[1]);
  }
  EXPECT_EQ(folded_share(mesh, apart), 0);
}

}  // namespace
}  // namespace crosspatch
