// The whole automatic map, between samplings of surfaces whose true correspondence is known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "level_sets.hpp"
#include "param/match.hpp"
#include "shapes.hpp"
#include "whole_map.hpp"

namespace crosspatch {
namespace {

using shapes::blended;
using shapes::capsule;
using shapes::level_set;
using shapes::ring;

Eigen::Matrix3d turned(double angle) {
  return Eigen::AngleAxisd(angle, Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
}

/// A capsule flattened along `flat`, that does not look the same when turned about its axis.
double limb(const Vector3d& p,
            const Vector3d& a,
            const Vector3d& b,
            double r,
            double s,
            const Vector3d& flat) {
  const Vector3d n = flat.normalized();
  const auto flattened = [&](const Vector3d& x) -> Vector3d { return x + 0.6 * x.dot(n) * n; };
  return capsule(flattened(p), flattened(a), flattened(b), r, s);
}

/// A body along x with a long tail, four legs and a head, no two limbs alike.
double animal(const Vector3d& p) {
  double d = limb(p, {-0.6, 0, 0}, {0.5, 0, 0}, 0.6, 0.5, {0, 1, 0.3});
  d = blended(d, limb(p, {0.5, 0, 0}, {2.7, 0, 0}, 0.34, 0.26, {0, 0, 1}), 0.1);  // tail
  d = blended(d, limb(p, {0.35, 0.2, 0}, {0.55, 0.55, -1.2}, 0.35, 0.3, {1, 0, 0}), 0.1);
  d = blended(d, limb(p, {0.35, -0.2, 0}, {0.5, -0.6, -1.0}, 0.35, 0.25, {0, 1, 0}), 0.1);
  d = blended(d, limb(p, {-0.6, 0.2, 0}, {-0.75, 0.5, -1.4}, 0.33, 0.27, {1, 0, 0}), 0.1);
  d = blended(d, limb(p, {-0.6, -0.2, 0}, {-0.9, -0.6, -0.85}, 0.35, 0.3, {0, 1, 0}), 0.1);
  return blended(d, limb(p, {-0.8, 0, 0.1}, {-1.3, 0.1, 1.1}, 0.4, 0.45, {0.5, 1, 0}), 0.1);
}

/// Bends what lies beyond x = `from` towards z along an arc of `curvature`: lengths along the axis
/// stay, those at height z change by the factor 1 - curvature z.
Vector3d bent(const Vector3d& p, double from, double curvature) {
  if (p.x() <= from) return p;
  const double angle = curvature * (p.x() - from), radius = 1 / curvature - p.z();
  return {from + radius * std::sin(angle), p.y(), 1 / curvature - radius * std::cos(angle)};
}

TriangleMesh moved(TriangleMesh mesh, const std::function<Vector3d(const Vector3d&)>& map) {
  for (int v = 0; v < mesh.vertex_count(); ++v) mesh.V.row(v) = map(mesh.position(v)).transpose();
  return mesh;
}

/// Distances between images of vertices and where they should be, in the root of the area they lie
/// on; of the first known.rows() vertices. `smooth` takes images from the mesh to the surface that
/// it samples.
struct Slip {
  double mean = 0, worst = 0;
};
Slip slip(const TriangleMesh& onto,
          const std::vector<SurfacePoint>& points,
          const std::vector<int>& point_of_vertex,
          const MatrixX3d& known,
          const std::function<Vector3d(const Vector3d&)>& smooth) {
  Slip slip;
  for (int v = 0; v < known.rows(); ++v) {
    const int q = point_of_vertex[static_cast<std::size_t>(v)];
    const double distance =
        (smooth(position(onto, points[static_cast<std::size_t>(q)])) - known.row(v).transpose())
            .norm();
    slip.mean += distance / static_cast<double>(known.rows());
    slip.worst = std::max(slip.worst, distance);
  }
  const double unit = std::sqrt(total_area(onto));
  return {slip.mean / unit, slip.worst / unit};
}

constexpr double kTailBase = 1.2, kTailCurvature = 0.6;
Vector3d wagged(const Vector3d& p) {
  return bent(p, kTailBase, kTailCurvature);
}
Vector3d unwagged(const Vector3d& p) {
  const double z = 1 / kTailCurvature - p.z(), x = p.x() - kTailBase;
  const double angle = std::atan2(x, z);
  if (x <= 0) return p;
  return {kTailBase + angle / kTailCurvature, p.y(), 1 / kTailCurvature - std::hypot(x, z)};
}

/// The animal in two samplings, the second with its tail bent.
const TriangleMesh& straight() {
  static const TriangleMesh mesh = level_set(animal, 3, 0.19, turned(1.9));
  return mesh;
}
const TriangleMesh& standing() {
  static const TriangleMesh mesh = level_set(animal, 3, 0.21, turned(0.5));
  return mesh;
}

/// Maps `source`, whose first vertices are those of standing(), to `target`, whose first vertices
/// are those of straight() with its tail bent.
void expect_bend(const TriangleMesh& source,
                 const TriangleMesh& target,
                 double slip_bound,
                 double median_bound) {
  const auto matched = match_and_map(source, target, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_FALSE(matched->is_partial());
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  expect_whole(*matched, source, target);
  const SurfaceMap& map = matched->result.map;
  const auto on_animal = [](const Vector3d& p) { return shapes::onto_surface(animal, p); };
  const Slip there = slip(target,
                          map.target,
                          map.point_of_source_vertex,
                          moved(standing(), wagged).V,
                          [&](const Vector3d& p) { return wagged(on_animal(unwagged(p))); });
  const Slip back = slip(source, map.source, map.point_of_target_vertex, straight().V, on_animal);
  EXPECT_LT(there.mean, slip_bound);
  EXPECT_LT(back.mean, slip_bound);
  EXPECT_LT(matched->result.quality.median, median_bound);
}

TEST(MatchAndMap, RecoversABentLimb) {
  // 1.7 times what is attained, 0.0017 and 0.0018, and a median of 4.12: meshes this coarse differ
  // from each other, and off the axis the bend is no isometry.
  expect_bend(standing(), moved(straight(), wagged), 3e-3, 4.25);
}

/// The same polyhedron with needles, from edges that are cut next to an end, and caps, from points
/// next to an edge: one of each in sixty faces. Vertices keep their numbers.
TriangleMesh with_slivers(const TriangleMesh& mesh, unsigned seed) {
  constexpr double kHeight = 1e-6;  // of edges and heights of faces
  constexpr unsigned kShare = 60;
  std::vector<Vector3d> points;
  for (int v = 0; v < mesh.vertex_count(); ++v) points.push_back(mesh.position(v));
  std::vector<std::array<int, 3>> faces;
  std::vector<bool> done(static_cast<std::size_t>(mesh.face_count()), false);
  std::mt19937 random(seed);
  const auto add = [&](const Vector3d& p) {
    points.push_back(p);
    return static_cast<int>(points.size()) - 1;
  };
  const auto cut_edge = [&](int h, int middle) {  // both parts of the face left of h
    faces.push_back({mesh.from(h), middle, mesh.tip(h)});
    faces.push_back({middle, mesh.to(h), mesh.tip(h)});
    done[static_cast<std::size_t>(face_of(h))] = true;
  };
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (done[static_cast<std::size_t>(f)]) continue;
    const int h = 3 * f + static_cast<int>(random() % 3),
              t = mesh.twin[static_cast<std::size_t>(h)];
    const Vector3d a = mesh.position(mesh.from(h)), b = mesh.position(mesh.to(h)),
                   c = mesh.position(mesh.tip(h));
    const auto kind = random() % kShare;
    if (kind == 0 && t >= 0 && !done[static_cast<std::size_t>(face_of(t))]) {
      const int middle = add(a + kHeight * (b - a));  // two needles and what is left of two faces
      cut_edge(h, middle);
      cut_edge(t, middle);
    } else if (kind == 1) {
      done[static_cast<std::size_t>(f)] = true;
      const int middle = add((1 - kHeight) * (a + b) / 2 + kHeight * c);  // a cap on the edge
      for (int k = 0; k < 3; ++k) faces.push_back({mesh.F(f, k), mesh.F(f, (k + 1) % 3), middle});
    } else {
      done[static_cast<std::size_t>(f)] = true;
      faces.push_back({mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)});
    }
  }
  return shapes::mesh_of(points, faces);
}

TEST(MatchAndMap, IsNotCrumpledBySlivers) {
  // Attained: 0.0053, a median of 4.19; with slivers not thickened in the end 0.016 and 6.3.
  expect_bend(with_slivers(standing(), 1), with_slivers(moved(straight(), wagged), 2), 8e-3, 4.5);
}

/// A ring whose tube is thin at an angle, so that there is one place to cut it, with lumps.
double lumpy_torus(const Vector3d& p) {
  double d = ring(
      p, {0, 0, 1}, 1, 0.42 - 0.2 * std::exp(6 * (std::cos(std::atan2(p.y(), p.x()) - 3.5) - 1)));
  d = blended(d, capsule(p, {1, 0.2, 0.2}, {1.1, 0.3, 0.7}, 0.25, 0.2), 0.05);
  d = blended(d, capsule(p, {-0.5, 0.8, -0.2}, {-0.7, 1.1, -0.5}, 0.3, 0.25), 0.05);
  return blended(d, capsule(p, {-0.2, -1.1, 0}, {-0.4, -1.7, 0.2}, 0.22, 0.2), 0.05);
}

double lumpy_double_torus(const Vector3d& p) {
  double d = lumpy_torus(p + Vector3d(0.8, 0, 0));
  const Vector3d axis = Vector3d(0.1, 0.5, 1).normalized(), q = p - Vector3d(1.15, 0.1, 0);
  d = blended(d,
              ring(q,
                   axis,
                   0.75,
                   0.34 - 0.17 * std::exp(6 * (std::cos(std::atan2(q.y(), q.x()) + 1.8) - 1))),
              0.05);
  return blended(d, capsule(q, {0.6, 0.2, 0}, {1.2, 0.5, 0.1}, 0.25, 0.2), 0.05);
}

/// Maps a solid's surface to another sampling of it.
void expect_recovered(const shapes::Solid& solid, double radius, double cell, int handles) {
  const TriangleMesh source = level_set(solid, radius, cell, turned(0.5));
  const TriangleMesh target = level_set(solid, radius, 0.93 * cell, turned(1.9));
  ASSERT_EQ(genus(source), handles);
  ASSERT_EQ(genus(target), handles);
  const auto matched = match_and_map(source, target, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_FALSE(matched->is_partial());
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  expect_whole(*matched, source, target);
  const SurfaceMap& map = matched->result.map;
  const Slip there =
      slip(target, map.target, map.point_of_source_vertex, source.V, [&](const Vector3d& p) {
        return shapes::onto_surface(solid, p);
      });
  const Slip back =
      slip(source, map.source, map.point_of_target_vertex, target.V, [&](const Vector3d& p) {
        return shapes::onto_surface(solid, p);
      });
  // Attained: at most 0.0037, medians up to 4.09; the meshes are coarse.
  EXPECT_LT(there.mean, 5e-3);
  EXPECT_LT(back.mean, 5e-3);
  EXPECT_LT(matched->result.quality.median, 4.2);
  EXPECT_LT(matched->result.quality.percentile_90, 5);
}

TEST(MatchAndMap, RecoversATorusInAnotherSampling) {
  expect_recovered(lumpy_torus, 2.2, 0.21, 1);
}

TEST(MatchAndMap, RecoversADoubleTorusInAnotherSampling) {
  expect_recovered(lumpy_double_torus, 2.8, 0.22, 2);
}

/// A bumpy sheet with a wavy rim, over rings of six, twelve, ... vertices that are turned by
/// `twist` more and more.
TriangleMesh sheet(int rings, double twist) {
  std::vector<Vector3d> points{Vector3d::Zero()};
  std::vector<std::array<int, 3>> faces;
  const auto at = [](int ring, int i) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring);
  };
  for (int k = 1; k <= rings; ++k)
    for (int i = 0; i < 6 * k; ++i) {
      const double r = static_cast<double>(k) / rings;
      const double u = std::numbers::pi / 3 * i / k,
                   angle = u + twist * (1 + r + 0.4 * std::sin(u));
      points.push_back(r * (1 + 0.15 * std::cos(2 * angle + 0.3) + 0.1 * std::cos(3 * angle)) *
                       Vector3d(std::cos(angle), std::sin(angle), 0));
      const int inner = i / k * (k - 1) + i % k;
      faces.push_back({at(k - 1, inner), at(k, i), at(k, i + 1)});
      if (i % k < k - 1) faces.push_back({at(k - 1, inner), at(k, i + 1), at(k - 1, inner + 1)});
    }
  for (Vector3d& p : points) {
    const auto bump = [&](double x, double y, double height, double width) {
      return height *
             std::exp(-(std::pow(p.x() - x, 2) + std::pow(p.y() - y, 2)) / (width * width));
    };
    p.z() = bump(0.5, 0.1, 0.4, 0.2) + bump(-0.3, 0.4, 0.3, 0.2) - bump(-0.4, -0.4, 0.25, 0.2);
  }
  return shapes::mesh_of(points, faces);
}

/// The largest distance of images of boundary vertices from the boundary.
double worst_off_rim(const TriangleMesh& from,
                     const TriangleMesh& onto,
                     const std::vector<SurfacePoint>& points,
                     const std::vector<int>& point_of_vertex) {
  const std::vector<int> rim = boundary_loops(onto)[0];
  double worst = 0;
  for (int h = 0; h < from.halfedge_count(); ++h) {
    if (from.twin[static_cast<std::size_t>(h)] >= 0) continue;
    const int q = point_of_vertex[static_cast<std::size_t>(from.from(h))];
    const Vector3d p = position(onto, points[static_cast<std::size_t>(q)]);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rim.size(); ++i)
      nearest = std::min(
          nearest,
          capsule(p, onto.position(rim[i]), onto.position(rim[(i + 1) % rim.size()]), 0, 0));
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(MatchAndMap, RecoversARolledSheetToItsRim) {
  const TriangleMesh source = sheet(16, 0.1), flat = sheet(18, -0.3);
  ASSERT_EQ(boundary_loops(source).size(), 1U);
  const auto roll = [](const Vector3d& p) { return bent(p, -0.2, 0.3); };
  const TriangleMesh target = moved(flat, roll);
  const auto matched = match_and_map(source, target, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_FALSE(matched->is_partial());
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  expect_whole(*matched, source, target);
  const SurfaceMap& map = matched->result.map;
  constexpr double kRounding = 1e-9;
  EXPECT_LT(worst_off_rim(source, target, map.target, map.point_of_source_vertex), kRounding);
  EXPECT_LT(worst_off_rim(target, source, map.source, map.point_of_target_vertex), kRounding);
  const auto as_it_is = [](const Vector3d& p) { return p; };
  const Slip there =
      slip(target, map.target, map.point_of_source_vertex, moved(source, roll).V, as_it_is);
  const Slip back = slip(source, map.source, map.point_of_target_vertex, flat.V, as_it_is);
  // Attained: 0.0027, a median of 4.01. Bumps, up to 0.4 high, are stretched by up to 0.12.
  EXPECT_LT(there.mean, 5e-3);
  EXPECT_LT(back.mean, 5e-3);
  EXPECT_LT(matched->result.quality.median, 4.05);
  EXPECT_LT(matched->result.quality.percentile_90, 4.5);
}

}  // namespace
}  // namespace crosspatch
