#include "param/point_map.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "param/map_quality.hpp"
#include "param/pull_back.hpp"
#include "shapes.hpp"
#include "transfer/carry_texture.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

std::vector<SurfacePoint> at_vertices(const TriangleMesh& mesh, const std::vector<int>& vertices) {
  std::vector<SurfacePoint> points;
  points.reserve(vertices.size());
  for (const int v : vertices) points.push_back(point_at_vertex(mesh, v));
  return points;
}

std::vector<int> all_vertices(const TriangleMesh& mesh) {
  std::vector<int> vertices(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(vertices.begin(), vertices.end(), 0);
  return vertices;
}

TriangleMesh egg(int levels) {
  TriangleMesh mesh = shapes::icosphere(levels);
  for (auto p : mesh.V.rowwise())
    p = Eigen::RowVector3d(1.6 * p.x() + 0.2 * p.y() * p.y(), p.y(), 0.8 * p.z() - 0.1 * p.x());
  return mesh;
}

/// The same shape with edges elsewhere.
TriangleMesh turned(TriangleMesh sphere) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.4, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  sphere.V = (sphere.V * turn.transpose()).eval();
  return sphere;
}

/// For each vertex of `a` the nearest vertex of `b`.
std::vector<int> nearest(const TriangleMesh& a, const TriangleMesh& b) {
  std::vector<int> result;
  for (int v = 0; v < a.vertex_count(); ++v) {
    Eigen::Index best = 0;
    (b.V.rowwise() - a.V.row(v)).rowwise().squaredNorm().minCoeff(&best);
    result.push_back(static_cast<int>(best));
  }
  return result;
}

/// How far the target's vertices go back to other places than their own, at most.
double largest_miss(const SurfaceMap& map, const TriangleMesh& source, const TriangleMesh& target) {
  double miss = 0;
  for (int v = 0; v < target.vertex_count(); ++v) {
    const int q = map.point_of_target_vertex[static_cast<std::size_t>(v)];
    if (q < 0) continue;
    const SurfacePoint& p = map.source[static_cast<std::size_t>(q)];
    miss = std::max(miss, (position(source, p) - target.position(v)).norm());
  }
  return miss;
}

TEST(PointMap, TheIdentityIsExact) {
  const TriangleMesh mesh = egg(3);
  const auto made = map_from_points(mesh, mesh, at_vertices(mesh, all_vertices(mesh)));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(validate(made->map, mesh, mesh)) << validate(made->map, mesh, mesh).error().message;
  EXPECT_EQ(made->map.polygon_count(), mesh.face_count());
  EXPECT_EQ(made->map.point_count(), mesh.vertex_count());
  EXPECT_EQ(largest_miss(made->map, mesh, mesh), 0);
  const PointMapStatistics& s = made->statistics;
  EXPECT_EQ(s.torn_source_triangles + s.turned_source_triangles + s.unmapped_target_triangles, 0);
  EXPECT_NEAR(s.source_coverage, 1, 1e-12);
}

TEST(PointMap, NearestVerticesCoverEverything) {
  const TriangleMesh a = shapes::icosphere(3), b = turned(shapes::icosphere(3));
  const auto made = map_from_points(a, b, at_vertices(b, nearest(a, b)));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->statistics.torn_source_triangles, 0);
  EXPECT_EQ(made->statistics.unmapped_target_triangles, 0);
  EXPECT_NEAR(measure_map(made->map, a, b).target_coverage, 1, 1e-6);
  // The nearest vertex is less than an edge away, and so is the way back.
  EXPECT_LT(largest_miss(made->map, a, b), 2 * mean_edge(b));
}

TEST(PointMap, ExactPointsGiveBackTheMap) {
  // Radial projection of one triangulation of the sphere to another.
  const TriangleMesh a = shapes::icosphere(3), b = turned(shapes::icosphere(3));
  std::vector<SurfacePoint> images;
  for (int v = 0; v < a.vertex_count(); ++v)
    for (int f = 0; f < b.face_count(); ++f) {
      Eigen::Matrix3d corners;
      for (int k = 0; k < 3; ++k) corners.col(k) = b.position(b.F(f, k));
      const Vector3d weights = corners.inverse() * a.position(v);
      if (weights.minCoeff() < 0) continue;
      images.push_back({f, weights / weights.sum()});
      break;
    }
  ASSERT_EQ(images.size(), static_cast<std::size_t>(a.vertex_count()));
  const auto made = map_from_points(a, b, images);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(validate(made->map, a, b)) << validate(made->map, a, b).error().message;
  EXPECT_EQ(measure_map(made->map, a, b).flipped, 0);
  // Both lie inside of the sphere by up to an edge squared over 8.
  EXPECT_LT(largest_miss(made->map, a, b), 0.25 * mean_edge(b));
}

TEST(PointMap, APermutationIsTorn) {
  const TriangleMesh mesh = shapes::icosphere(4);
  std::vector<int> vertices = all_vertices(mesh);
  std::mt19937 random(5);
  for (std::size_t i = vertices.size(); i > 1; --i)
    std::swap(vertices[i - 1], vertices[random() % i]);
  const auto made = map_from_points(mesh, mesh, at_vertices(mesh, vertices));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_GT(made->statistics.torn_source_triangles, 0.97 * mesh.face_count());
  EXPECT_GT(made->statistics.unmapped_target_triangles, 0.9 * mesh.face_count());
}

TEST(PointMap, AMirrorImageIsTurnedOverAndNotTorn) {
  const TriangleMesh mesh = egg(3);
  MatrixX3d V = mesh.V;
  V.col(2) *= -1;
  MatrixX3i F = mesh.F;
  F.col(1).swap(F.col(2));
  const TriangleMesh mirrored = make_mesh(V, F).value();
  const auto made = map_from_points(mesh, mirrored, at_vertices(mirrored, all_vertices(mesh)));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->statistics.torn_source_triangles, 0);
  EXPECT_EQ(made->statistics.turned_source_triangles, 0) << "all alike";
  EXPECT_EQ(made->statistics.unmapped_target_triangles, 0);
  EXPECT_EQ(measure_map(made->map, mesh, mirrored).flipped, mesh.face_count());
}

TEST(PointMap, WhatHasNoImageLeavesItsPlaceEmpty) {
  const TriangleMesh mesh = shapes::icosphere(3);
  std::vector<SurfacePoint> images = at_vertices(mesh, all_vertices(mesh));
  int unmapped = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.V(v, 2) > 0) {
      images[static_cast<std::size_t>(v)] = {};
      ++unmapped;
    }
  const auto made = map_from_points(mesh, mesh, images);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->statistics.unmapped_source_vertices, unmapped);
  EXPECT_EQ(made->statistics.torn_source_triangles, 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    double highest = -1;
    for (int k = 0; k < 3; ++k) highest = std::max(highest, mesh.V(mesh.F(f, k), 2));
    const auto& faces = made->map.target_face;
    const bool mapped = std::find(faces.begin(), faces.end(), f) != faces.end();
    if (highest <= 0) {
      EXPECT_TRUE(mapped) << f;
    } else if (highest > 2 * mean_edge(mesh)) {
      EXPECT_FALSE(mapped) << f;
    }
  }
}

TEST(PointMap, OpenSurfacesKeepTheirOutline) {
  const TriangleMesh mesh = shapes::grid(8);
  const auto made = map_from_points(mesh, mesh, at_vertices(mesh, all_vertices(mesh)));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(validate(made->map, mesh, mesh)) << validate(made->map, mesh, mesh).error().message;
  EXPECT_EQ(made->statistics.unmapped_target_triangles, 0);
}

TEST(PointMap, TrianglesAlongAnOutlineAreKept) {
  const TriangleMesh a = shapes::jittered_grid(shapes::grid(9), 9, 1);
  const TriangleMesh b = shapes::jittered_grid(shapes::grid(8), 8, 2);
  std::vector<SurfacePoint> images;
  for (int v = 0; v < a.vertex_count(); ++v)
    for (int f = 0; f < b.face_count(); ++f) {
      const Vector3d bary = shapes::planar_barycentric(b, f, a.position(v).head<2>());
      if (bary.minCoeff() < -1e-12) continue;
      images.push_back({f, bary.cwiseMax(0.0)});
      break;
    }
  ASSERT_EQ(images.size(), static_cast<std::size_t>(a.vertex_count()));
  const auto made = map_from_points(a, b, images);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(validate_partial(made->map, a, b));
  EXPECT_EQ(made->statistics.unmapped_target_triangles, 0);
  EXPECT_EQ(measure_map(made->map, a, b).flipped, 0);
  EXPECT_LT(largest_miss(made->map, a, b), 1e-9) << "planes have no chords";
}

TEST(PointMap, CarriesTexturesWithoutCracksOrStraddledSeams) {
  // The two halves of the sphere have charts of their own, u below 0.45 and above 0.55.
  const TriangleMesh a = shapes::icosphere(3), b = turned(shapes::icosphere(3));
  shapes::Surface source = shapes::surface_of(a);
  shapes::texture(
      source,
      [&](int f, const Vector3d& p) {
        const double middle = a.V(a.F(f, 0), 0) + a.V(a.F(f, 1), 0) + a.V(a.F(f, 2), 0);
        const double u = 0.25 + 0.15 * p[1];
        return Vector2d(middle < 0 ? u : 0.5 + u, 0.5 + 0.4 * p[2]);
      },
      512);
  const shapes::Surface target = shapes::surface_of(b);
  for (const bool folded : {false, true}) {
    // Vertices that change places with a neighbour fold the map all over.
    std::vector<int> images = nearest(a, b);
    if (folded)
      for (int v = 0; v < a.vertex_count(); v += 7) {
        const int w = a.to(a.out[static_cast<std::size_t>(v)]);
        std::swap(images[static_cast<std::size_t>(v)], images[static_cast<std::size_t>(w)]);
      }
    const auto made = map_from_points(a, b, at_vertices(b, images));
    ASSERT_TRUE(made) << made.error().message;
    const auto carried = carry_texture(source.view(), target.view(), made->map);
    ASSERT_TRUE(carried) << carried.error().message;
    EXPECT_GT(carried->statistics.coverage, folded ? 0.9 : 1 - 1e-9);
    const TexturedMesh& mesh = carried->mesh;
    EXPECT_EQ(shapes::loose_sides(mesh), 0);
    for (int t = 0; t < mesh.triangle_count(); ++t) {
      if (mesh.materials[static_cast<std::size_t>(mesh.material[static_cast<std::size_t>(t)])]
              .name != "skin")
        continue;
      int right = 0;
      for (std::size_t k = 0; k < 3; ++k)
        right += mesh.uv_sets[0][3 * static_cast<std::size_t>(t) + k][0] > 0.5 ? 1 : 0;
      EXPECT_TRUE(right == 0 || right == 3) << t;
    }
  }
}

TEST(PointMap, HandlesAreCut) {
  const TriangleMesh mesh = shapes::torus(2, 0.7, 24, 12);
  const auto made = map_from_points(mesh, mesh, at_vertices(mesh, all_vertices(mesh)));
  ASSERT_TRUE(made) << made.error().message;
  // The cut runs along edges, which both meshes share.
  EXPECT_TRUE(validate(made->map, mesh, mesh)) << validate(made->map, mesh, mesh).error().message;
  EXPECT_EQ(made->statistics.unmapped_target_triangles, 0);
  // Where edges lie elsewhere, triangles that reach over the cut are lost, no others.
  const TriangleMesh other = shapes::torus(2, 0.7, 25, 13);
  const auto near = map_from_points(mesh, other, at_vertices(other, nearest(mesh, other)));
  ASSERT_TRUE(near) << near.error().message;
  EXPECT_GT(measure_map(near->map, mesh, other).target_coverage, 0.85);
}

}  // namespace
}  // namespace crosspatch
