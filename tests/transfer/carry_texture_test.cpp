#include "transfer/carry_texture.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <set>

#include "core/index.hpp"
#include "shapes.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

using shapes::Surface;

double double_area(const TexturedMesh& mesh, int t) {
  const Vector3d a = mesh.positions.row(mesh.triangles(t, 0)).transpose();
  const Vector3d b = mesh.positions.row(mesh.triangles(t, 1)).transpose();
  const Vector3d c = mesh.positions.row(mesh.triangles(t, 2)).transpose();
  return (b - a).cross(c - a).norm();
}

double area_of(const TexturedMesh& mesh) {
  double sum = 0;
  for (int t = 0; t < mesh.triangle_count(); ++t) sum += double_area(mesh, t) / 2;
  return sum;
}

/// A planar source with two UV islands (faces whose middle is left or right of x = 1/2; u <= 0.45
/// or u >= 0.55) and UVs that bend over each source face's neighbourhood.
Surface two_islands(int n, unsigned seed, int texels) {
  Surface s = shapes::surface_of(shapes::jittered_grid(shapes::grid(n), n, seed));
  const TriangleMesh& mesh = s.prepared.mesh;
  shapes::texture(
      s,
      [&](int f, const Vector3d& p) {
        const double middle =
            (mesh.V(mesh.F(f, 0), 0) + mesh.V(mesh.F(f, 1), 0) + mesh.V(mesh.F(f, 2), 0)) / 3;
        // Sides of an island meet at most at x = 0.5 +- a cell, which this keeps below 0.45.
        const double u = 0.3 * p[0] + 0.05 * p[1] * p[1];
        return Vector2d(middle < 0.5 ? u : 0.65 + u, p[1] + 0.1 * p[0] * p[0]);
      },
      texels);
  return s;
}

Vector2d exact_uv(const Surface& source, const Vector2d& p) {
  const TriangleMesh& mesh = source.prepared.mesh;
  int best = 0;
  double inside = -1e9;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const double least = shapes::planar_barycentric(mesh, f, p).minCoeff();
    if (least > inside) {
      inside = least;
      best = f;
    }
  }
  const Vector3d b = shapes::planar_barycentric(mesh, best, p);
  const auto& uv = source.soup.uv_sets[0];
  return b[0] * uv[idx(3 * best)] + b[1] * uv[idx(3 * best + 1)] + b[2] * uv[idx(3 * best + 2)];
}

/// Flat triangles of `mesh` as a mesh of their own, to locate points in.
TriangleMesh as_mesh(const TexturedMesh& mesh) {
  TriangleMesh m;
  m.V = mesh.positions;
  m.F = mesh.triangles;
  return m;
}

TEST(CarryTexture, IdentityWithASeamKeepsTrianglesAndUvs) {
  Surface sphere = shapes::surface_of(shapes::icosphere(2));
  const TriangleMesh& mesh = sphere.prepared.mesh;
  // Longitude and latitude, wrapped per face: a seam where the longitude jumps.
  shapes::texture(
      sphere,
      [&](int f, const Vector3d& p) {
        const Vector3d c = (mesh.position(mesh.F(f, 0)) + mesh.position(mesh.F(f, 1)) +
                            mesh.position(mesh.F(f, 2))) /
                           3;
        double u = std::atan2(p[1], p[0]) / (2 * std::numbers::pi);
        const double middle = std::atan2(c[1], c[0]) / (2 * std::numbers::pi);
        u += std::round(middle - u);
        return Vector2d(u, p[2]);
      },
      512);
  const auto carried = carry_texture(sphere.view(), sphere.view(), identity_map(mesh));
  ASSERT_TRUE(carried) << carried.error().message;
  const TexturedMesh& out = carried->mesh;
  ASSERT_TRUE(validate(out)) << validate(out).error().message;
  ASSERT_EQ(out.triangle_count(), mesh.face_count());
  EXPECT_EQ(carried->statistics.max_uv_error_texels, 0);
  EXPECT_NEAR(carried->statistics.coverage, 1, 1e-12);  // rounding of area sums
  EXPECT_GT(carried->statistics.seam_cuts, 0);
  std::set<std::pair<int, int>> seen;
  for (int t = 0; t < out.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = out.positions.row(out.triangles(t, k)).transpose();
      int corner = 0;
      while (mesh.position(mesh.F(out.target_face[idx(t)], corner)) != p) ASSERT_LT(++corner, 3);
      const int h = 3 * out.target_face[idx(t)] + corner;
      seen.emplace(out.target_face[idx(t)], corner);
      EXPECT_LT((out.uv_sets[0][idx(3 * t + k)] - sphere.soup.uv_sets[0][idx(h)]).norm(), 1e-8);
    }
  EXPECT_EQ(seen.size(), idx(mesh.halfedge_count()));
}

class PlanarTransfer : public testing::TestWithParam<std::pair<int, int>> {
 protected:
  void SetUp() override {
    const auto [n, m] = GetParam();
    source_ = two_islands(n, 1, 256);
    target_ = shapes::surface_of(shapes::jittered_grid(shapes::grid(m), m, 2));
    map_ = shapes::planar_overlay(source_.prepared.mesh, target_.prepared.mesh);
    const Status valid = validate(map_, source_.prepared.mesh, target_.prepared.mesh);
    ASSERT_TRUE(valid) << valid.error().message;
  }

  Surface source_, target_;
  SurfaceMap map_;
};

TEST_P(PlanarTransfer, SurfaceStaysAndMeshIsConforming) {
  const auto carried = carry_texture(source_.view(), target_.view(), map_);
  ASSERT_TRUE(carried) << carried.error().message;
  const TexturedMesh& out = carried->mesh;
  ASSERT_TRUE(validate(out)) << validate(out).error().message;
  EXPECT_NEAR(area_of(out), 1, 1e-9);  // the unit square; rounding
  const TriangleMesh& target = target_.prepared.mesh;
  for (int t = 0; t < out.triangle_count(); ++t) {
    EXPECT_GT(double_area(out, t), 0);
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = out.positions.row(out.triangles(t, k)).transpose();
      EXPECT_GT(shapes::planar_barycentric(target, out.target_face[idx(t)], p.head<2>()).minCoeff(),
                -1e-9);  // rounding of the barycentric round trip
    }
  }
  // Loose sides lie on the outline only, where each has length at most 1 and all sum up to 4.
  double outline = 0;
  std::set<std::pair<int, int>> sides;
  for (int t = 0; t < out.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) sides.emplace(out.triangles(t, k), out.triangles(t, (k + 1) % 3));
  EXPECT_EQ(sides.size(), idx(3 * out.triangle_count()));
  for (const auto& [i, j] : sides)
    if (!sides.contains({j, i})) outline += (out.positions.row(i) - out.positions.row(j)).norm();
  EXPECT_NEAR(outline, 4, 1e-9);
}

TEST_P(PlanarTransfer, NoTriangleTouchesTwoIslands) {
  const auto carried = carry_texture(source_.view(), target_.view(), map_);
  ASSERT_TRUE(carried);
  const auto& uv = carried->mesh.uv_sets[0];
  for (int t = 0; t < carried->mesh.triangle_count(); ++t) {
    const bool left = uv[idx(3 * t)][0] < 0.5;
    EXPECT_EQ(left, uv[idx(3 * t + 1)][0] < 0.5);
    EXPECT_EQ(left, uv[idx(3 * t + 2)][0] < 0.5);
  }
  EXPECT_GT(carried->statistics.seam_cuts, 0);
}

TEST_P(PlanarTransfer, UvIsWithinHalfATexelOfTheMap) {
  const auto carried = carry_texture(source_.view(), target_.view(), map_);
  ASSERT_TRUE(carried);
  EXPECT_LE(carried->statistics.max_uv_error_texels, 0.5);
  const TriangleMesh out = as_mesh(carried->mesh);
  const auto& uv = carried->mesh.uv_sets[0];
  std::mt19937 random(7);
  int beyond = 0, points = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector2d p(double(random() % 100000) / 1e5, double(random() % 100000) / 1e5);
    for (int t = 0; t < carried->mesh.triangle_count(); ++t) {
      const Vector3d b = shapes::planar_barycentric(out, t, p);
      if (b.minCoeff() < 1e-9) continue;
      const Vector2d carried_uv =
          b[0] * uv[idx(3 * t)] + b[1] * uv[idx(3 * t + 1)] + b[2] * uv[idx(3 * t + 2)];
      ++points;
      beyond += (carried_uv - exact_uv(source_, p)).norm() * 256 > 0.5 + 1e-6 ? 1 : 0;  // rounding
      break;
    }
  }
  EXPECT_GT(points, 3900);
  EXPECT_EQ(beyond, 0);
}

TEST_P(PlanarTransfer, ToleranceTradesTrianglesForAccuracy) {
  int previous = std::numeric_limits<int>::max();
  for (const double tolerance : {0.0, 0.1, 0.5, 5.0, 1e6}) {
    const auto carried =
        carry_texture(source_.view(), target_.view(), map_, {.uv_tolerance_texels = tolerance});
    ASSERT_TRUE(carried);
    EXPECT_LE(carried->statistics.max_uv_error_texels, tolerance);
    EXPECT_LE(carried->statistics.triangles, previous);
    previous = carried->statistics.triangles;
  }
  // With nothing but the seams left to cut along, faces away from them stay whole.
  std::set<int> seam_faces;
  for (int p = 0; p < map_.polygon_count(); ++p) {
    double least = 1, most = 0;
    for (int k = 0; k < 3; ++k) {
      const double u = source_.soup.uv_sets[0][idx(3 * map_.source_face[idx(p)] + k)][0];
      least = std::min(least, u);
      most = std::max(most, u);
    }
    seam_faces.insert(2 * map_.target_face[idx(p)] + (least < 0.5 ? 0 : 1));
  }
  const auto coarse =
      carry_texture(source_.view(), target_.view(), map_, {.uv_tolerance_texels = 1e6});
  std::vector<int> pieces(idx(target_.prepared.mesh.face_count()), 0);
  for (const int f : coarse->mesh.target_face) ++pieces[idx(f)];
  const TriangleMesh& target = target_.prepared.mesh;
  const auto both = [&](int f) {
    return seam_faces.contains(2 * f) && seam_faces.contains(2 * f + 1);
  };
  for (int f = 0; f < target.face_count(); ++f) {
    bool near = both(f);
    for (int k = 0; k < 3; ++k) {
      const int twin = target.twin[idx(3 * f + k)];
      near = near || (twin >= 0 && both(face_of(twin)));
    }
    if (!near) {
      EXPECT_EQ(pieces[idx(f)], 1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SourceAndTargetCells,
                         PlanarTransfer,
                         testing::Values(std::pair(8, 3), std::pair(5, 9), std::pair(12, 12)));

TEST(CarryTexture, UnfilledFaceBecomesUnmappedWithoutGaps) {
  Surface source = two_islands(6, 3, 256);
  source.soup.corner_colors.assign(idx(source.soup.corner_count()), {0.2F, 0.3F, 0.4F, 1});
  const Surface target = shapes::surface_of(shapes::jittered_grid(shapes::grid(4), 4, 4));
  SurfaceMap map = shapes::planar_overlay(source.prepared.mesh, target.prepared.mesh);
  // Take away one polygon: its target face is only partly filled.
  const int face = 13;
  SurfaceMap torn = map;
  torn.polygon_begin = {0};
  torn.corner.clear();
  torn.source_face.clear();
  torn.target_face.clear();
  bool taken = false;
  for (int p = 0; p < map.polygon_count(); ++p) {
    if (map.target_face[idx(p)] == face && !std::exchange(taken, true)) continue;
    torn.corner.insert(torn.corner.end(),
                       map.corner.begin() + map.polygon_begin[idx(p)],
                       map.corner.begin() + map.polygon_begin[idx(p + 1)]);
    torn.polygon_begin.push_back(static_cast<int>(torn.corner.size()));
    torn.source_face.push_back(map.source_face[idx(p)]);
    torn.target_face.push_back(map.target_face[idx(p)]);
  }
  const auto whole = carry_texture(source.view(), target.view(), map);
  const auto carried = carry_texture(source.view(), target.view(), torn);
  ASSERT_TRUE(whole && carried);
  ASSERT_TRUE(validate(carried->mesh));
  EXPECT_EQ(carried->statistics.unmapped_faces, 1);
  const double lost = face_areas(target.prepared.mesh)[face];
  EXPECT_NEAR(carried->statistics.coverage, 1 - lost, 1e-9);  // of area 1
  EXPECT_NEAR(area_of(carried->mesh), 1, 1e-9);
  for (int t = 0; t < carried->mesh.triangle_count(); ++t) {
    const bool unmapped = carried->mesh.target_face[idx(t)] == face;
    EXPECT_EQ(carried->mesh.materials[idx(carried->mesh.material[idx(t)])].name == "unmapped",
              unmapped);
    EXPECT_FLOAT_EQ(carried->mesh.colors[idx(3 * t)][0], unmapped ? 1 : 0.2F);
  }
  EXPECT_EQ(shapes::loose_sides(carried->mesh), shapes::loose_sides(whole->mesh));
}

TEST(CarryTexture, MaterialsAreCutApartAndMissingUvsAreUnmapped) {
  Surface source = two_islands(6, 5, 256);
  const int faces = source.prepared.mesh.face_count();
  source.soup.materials.emplace_back().name = "horn";
  for (int f = faces / 2; f < faces; ++f) source.soup.polygon_material[idx(f)] = 1;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  source.soup.uv_sets[0][7] = {nan, nan};                   // face 2, whose material has a texture
  source.soup.uv_sets[0][idx(3 * faces - 1)] = {nan, nan};  // the last face's has none
  const Surface target = shapes::surface_of(shapes::jittered_grid(shapes::grid(3), 3, 6));
  const SurfaceMap map = shapes::planar_overlay(source.prepared.mesh, target.prepared.mesh);
  const auto carried = carry_texture(source.view(), target.view(), map);
  ASSERT_TRUE(carried) << carried.error().message;
  const TexturedMesh& out = carried->mesh;
  ASSERT_TRUE(validate(out)) << validate(out).error().message;
  std::map<std::string, double> area;
  for (int t = 0; t < out.triangle_count(); ++t)
    area[out.materials[idx(out.material[idx(t)])].name] += double_area(out, t) / 2;
  const Eigen::VectorXd areas = face_areas(source.prepared.mesh);
  EXPECT_NEAR(area["unmapped"], areas[2], 1e-9);
  EXPECT_NEAR(area["horn"], areas.tail(faces - faces / 2).sum(), 1e-9);
  EXPECT_NEAR(area["skin"], areas.head(faces / 2).sum() - areas[2], 1e-9);
}

TEST(CarryTexture, VertexColoursAreCarriedLinearly) {
  Surface source = shapes::surface_of(shapes::jittered_grid(shapes::grid(5), 5, 8));
  for (int h = 0; h < source.prepared.mesh.halfedge_count(); ++h) {
    const Vector3d p = source.prepared.mesh.position(source.prepared.mesh.from(h));
    source.soup.corner_colors.push_back({float(p[0]), float(p[1]), 0.25F, 1.F});
  }
  const Surface target = shapes::surface_of(shapes::jittered_grid(shapes::grid(2), 2, 9));
  const SurfaceMap map = shapes::planar_overlay(source.prepared.mesh, target.prepared.mesh);
  const auto carried = carry_texture(source.view(), target.view(), map);
  ASSERT_TRUE(carried) << carried.error().message;
  // Colours are linear in the plane: no cut is needed.
  ASSERT_EQ(carried->mesh.triangle_count(), target.prepared.mesh.face_count());
  EXPECT_EQ(carried->mesh.materials.at(0).name, "default");
  for (int t = 0; t < carried->mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto& rgba = carried->mesh.colors[idx(3 * t + k)];
      const auto p = carried->mesh.positions.row(carried->mesh.triangles(t, k));
      EXPECT_NEAR(rgba[0], p[0], 1e-6);  // single precision
      EXPECT_NEAR(rgba[1], p[1], 1e-6);
    }
}

TEST(CarryTexture, BadOptionsAndForeignMapsAreNamed) {
  const Surface source = two_islands(2, 1, 64);
  const SurfaceMap map = identity_map(source.prepared.mesh);
  const auto negative =
      carry_texture(source.view(), source.view(), map, {.uv_tolerance_texels = -1});
  ASSERT_FALSE(negative);
  EXPECT_EQ(negative.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(negative.error().message, "UV tolerance -1 is negative");
  const auto foreign =
      carry_texture(source.view(), source.view(), identity_map(shapes::icosphere(1)));
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::kInternal);
}

}  // namespace
}  // namespace crosspatch
