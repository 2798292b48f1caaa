#include "param/pull_back.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// A source triangle in space, at the images of its corners.
struct ImageTriangle {
  int face = -1;
  std::array<Vector3d, 3> corner;
  Vector3d side = Vector3d::Zero();  ///< the target's normal there
  double doubled_area = 0;
  double reach = 0;  ///< how far from it target vertices may lie
  bool turned = false;
};

/// Weights of the point of segment pq that is nearest to x.
double nearest_on_segment(const Vector3d& x, const Vector3d& p, const Vector3d& q) {
  const double squared = (q - p).squaredNorm();
  return squared > 0 ? std::clamp((x - p).dot(q - p) / squared, 0.0, 1.0) : 0.0;
}

/// Barycentric coordinates of the triangle's point that is nearest to x.
Vector3d nearest_on_triangle(const Vector3d& x, const std::array<Vector3d, 3>& c) {
  const Vector3d u = c[1] - c[0], v = c[2] - c[0], w = x - c[0];
  const Vector3d n = u.cross(v);
  const double squared = n.squaredNorm();
  // Squared sine below which the plane of the triangle is rounding.
  if (squared > 1e-20 * u.squaredNorm() * v.squaredNorm()) {
    const double b1 = w.cross(v).dot(n) / squared, b2 = u.cross(w).dot(n) / squared;
    const Vector3d bary(1 - b1 - b2, b1, b2);
    if (bary.minCoeff() >= 0) return bary;
  }
  Vector3d best = Vector3d::UnitX();
  double best_distance = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    const double t = nearest_on_segment(x, c[idx(k)], c[idx(l)]);
    const double distance = (c[idx(k)] + t * (c[idx(l)] - c[idx(k)]) - x).squaredNorm();
    if (distance >= best_distance) continue;
    best_distance = distance;
    best.setZero();
    best[k] = 1 - t;
    best[l] = t;
  }
  return best;
}

/// Triangles by the cells of a grid that their surroundings touch.
class Grid {
 public:
  Grid(const std::vector<ImageTriangle>& triangles, double cell) : cell_(cell) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const ImageTriangle& t = triangles[i];
      const Vector3d low =
          t.corner[0].cwiseMin(t.corner[1]).cwiseMin(t.corner[2]).array() - t.reach;
      const Vector3d high =
          t.corner[0].cwiseMax(t.corner[1]).cwiseMax(t.corner[2]).array() + t.reach;
      const Cell a = cell_of(low), b = cell_of(high);
      for (int x = a[0]; x <= b[0]; ++x)
        for (int y = a[1]; y <= b[1]; ++y)
          for (int z = a[2]; z <= b[2]; ++z) cells_[key({x, y, z})].push_back(static_cast<int>(i));
    }
  }

  /// Triangles that may be near, in ascending order; others may be among them.
  [[nodiscard]] const std::vector<int>& near(const Vector3d& x) const {
    static const std::vector<int> kNone;
    const auto found = cells_.find(key(cell_of(x)));
    return found == cells_.end() ? kNone : found->second;
  }

 private:
  using Cell = std::array<int, 3>;
  [[nodiscard]] Cell cell_of(const Vector3d& x) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) cell[idx(k)] = static_cast<int>(std::floor(x[k] / cell_));
    return cell;
  }
  /// Cells far apart may share a key; that costs a look at a distant triangle, no more.
  static std::uint64_t key(const Cell& c) {
    const auto part = [](int i) { return static_cast<std::uint64_t>(i) & 0x1fffffU; };
    return part(c[0]) << 42U | part(c[1]) << 21U | part(c[2]);
  }

  double cell_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

Vector3d normal_at(const TriangleMesh& mesh, const MatrixX3d& normals, const SurfacePoint& p) {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) sum += p.bary[k] * normals.row(mesh.F(p.face, k)).transpose();
  return sum;
}

/// Leaves out triangles that have no neighbour: nothing is continuous there. Tells which are left.
std::vector<bool> leave_out_lone(const TriangleMesh& source,
                                 std::vector<ImageTriangle>& triangles) {
  std::vector<bool> usable(idx(source.face_count()), false);
  for (const ImageTriangle& t : triangles) usable[idx(t.face)] = true;
  const std::vector<bool> before = usable;
  for (const ImageTriangle& t : triangles) {
    bool lone = source.face_count() > 1;
    for (int h = 3 * t.face; h < 3 * t.face + 3; ++h)
      if (const int twin = source.twin[idx(h)]; twin >= 0 && before[idx(face_of(twin))])
        lone = false;
    if (lone) usable[idx(t.face)] = false;
  }
  std::erase_if(triangles, [&](const ImageTriangle& t) { return !usable[idx(t.face)]; });
  return usable;
}

/// Whether the point lies on an edge of its face with no usable face across.
bool on_border(const TriangleMesh& source, const std::vector<bool>& usable, const SurfacePoint& p) {
  for (int k = 0; k < 3; ++k) {
    if (p.bary[k] != 0) continue;
    const int twin = source.twin[idx(3 * p.face + (k + 1) % 3)];
    if (twin < 0 || !usable[idx(face_of(twin))]) return true;
  }
  return false;
}

}  // namespace

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    sum += (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).norm();
  return mesh.halfedge_count() > 0 ? sum / mesh.halfedge_count() : 0;
}

PullBack pull_back(const TriangleMesh& source,
                   const TriangleMesh& target,
                   const std::vector<SurfacePoint>& images,
                   double stretch,
                   double slack) {
  const MatrixX3d normals = vertex_normals(target);
  const double edge = mean_edge(target);
  PullBack result;
  std::vector<ImageTriangle> triangles;
  int mapped_triangles = 0;
  for (int f = 0; f < source.face_count(); ++f) {
    ImageTriangle t;
    t.face = f;
    bool mapped = true, torn = false;
    double longest = 0;
    for (int k = 0; k < 3 && mapped; ++k) {
      const SurfacePoint& p = images[idx(source.F(f, k))];
      mapped = p.valid();
      if (!mapped) continue;
      t.corner[idx(k)] = position(target, p);
      t.side += normal_at(target, normals, p);
    }
    if (!mapped) continue;
    for (int k = 0; k < 3; ++k) {
      const double image = (t.corner[idx((k + 1) % 3)] - t.corner[idx(k)]).norm();
      const double length =
          (source.position(source.F(f, (k + 1) % 3)) - source.position(source.F(f, k))).norm();
      torn = torn || image > stretch * length + slack;
      longest = std::max(longest, image);
    }
    ++mapped_triangles;
    if (torn) continue;
    const Vector3d normal = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]);
    t.doubled_area = normal.norm();
    t.reach = std::max(longest / 2, edge);
    t.turned = normal.dot(t.side) < 0;
    triangles.push_back(t);
  }
  const std::vector<bool> usable = leave_out_lone(source, triangles);
  result.torn_triangles = mapped_triangles - static_cast<int>(triangles.size());
  const auto turned = std::count_if(
      triangles.begin(), triangles.end(), [](const ImageTriangle& t) { return t.turned; });
  const auto straight = static_cast<std::ptrdiff_t>(triangles.size()) - turned;
  const bool mirrored = turned > straight;  // a map of the whole to its mirror image
  if (mirrored)
    for (ImageTriangle& t : triangles) t.turned = !t.turned;
  result.turned_triangles = static_cast<int>(std::min(turned, straight));

  const Grid grid(triangles, 2 * std::max(edge, 1e-300));
  const double same = 1e-9 * edge;
  for (int v = 0; v < target.vertex_count(); ++v) {
    const Vector3d x = target.position(v), normal = normals.row(v).transpose();
    const ImageTriangle* best = nullptr;
    double best_distance = 0;
    SurfacePoint& point = result.points.emplace_back();
    for (const int i : grid.near(x)) {
      const ImageTriangle& t = triangles[idx(i)];
      if (!(t.side.dot(normal) > 0)) continue;  // the other side of a thin part
      const Vector3d bary = nearest_on_triangle(x, t.corner);
      const Vector3d nearest =
          bary[0] * t.corner[0] + bary[1] * t.corner[1] + bary[2] * t.corner[2];
      double distance = (nearest - x).norm();
      // Past the border of what is mapped nothing goes on, only the border is as coarse as that.
      if (distance > (on_border(source, usable, {t.face, bary}) ? edge / 2 : t.reach)) continue;
      if (t.turned) distance += edge / 2;
      if (best != nullptr &&
          (distance > best_distance + same ||
           (distance >= best_distance - same && t.doubled_area <= best->doubled_area)))
        continue;
      best = &t;
      best_distance = distance;
      point = {t.face, bary};
    }
  }
  return result;
}

}  // namespace crosspatch
