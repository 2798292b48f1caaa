// Notation: X row a is source vertex a on the sphere, scaled; Y_u = sum s_k X_k is the place of
// target vertex u, with s its barycentric coordinates on the source. A point b (barycentric) of the
// target triangle uvw lies at y = b0 Y_u + b1 Y_v + b2 Y_w, and in source face F where
// det(X_a, X_b, y) >= 0 for each edge (a, b) of F: linear functions of b, by which the triangle is
// clipped. Signs at points on a source edge or vertex are exact, because their zero terms are left
// out, and what is decided along an edge of the target depends on its two ends only, so that both
// its triangles are cut alike.
#include "param/sphere_clip.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// One target triangle, gone back to the sphere.
class Clipper {
 public:
  Clipper(const SphereSource& source,
          const std::array<SurfacePoint, 3>& points,
          const std::array<int, 3>& vertices)
      : source_(source), points_(points), vertices_(vertices) {}

  /// The polygons by which source faces fill the triangle; nothing where they do not fill it.
  std::vector<ClippedFace> run() {
    std::vector<int> waiting;
    std::set<int> seen;
    const auto visit = [&](int face) {
      if (seen.insert(face).second) waiting.push_back(face);
    };
    for (const SurfacePoint& p : points_)
      for (const int face : faces_at(source_.mesh, p)) visit(face);
    std::vector<ClippedFace> result;
    double area = 0;
    // Ours: a triangle over more source faces than this is no triangle of a continuous map.
    constexpr std::size_t kMostFaces = 5000;
    for (std::size_t i = 0; i < waiting.size() && i < kMostFaces; ++i) {
      ClippedFace polygon = clip(waiting[i]);
      if (polygon.corners.size() < 3) continue;
      for (int k = 0; k < 3; ++k) {
        const int h = 3 * waiting[i] + k;
        const ClipLine line = edge_line(h);
        if (std::find(polygon.lines.begin(), polygon.lines.end(), line) != polygon.lines.end() &&
            source_.mesh.twin[idx(h)] >= 0)
          visit(face_of(source_.mesh.twin[idx(h)]));
      }
      area += area_share(polygon);
      result.push_back(std::move(polygon));
    }
    constexpr double kMissing = 1e-7;  // as finely as the transfer asks whether a face is filled
    if (std::abs(area - 1) > kMissing) return {};
    return result;
  }

 private:
  [[nodiscard]] ClipLine edge_line(int h) const {
    const auto [a, b] = std::minmax({source_.mesh.from(h), source_.mesh.to(h)});
    return {-1, a, b};
  }

  /// det(X_a, X_b, Y) at a corner of the triangle.
  [[nodiscard]] double value(const ClipLine& line, int corner) const {
    const SurfacePoint& p = points_[idx(corner)];
    const Vector3d n =
        Vector3d(source_.X.row(line.a).transpose()).cross(source_.X.row(line.b).transpose());
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const int v = source_.mesh.F(p.face, k);
      if (v != line.a && v != line.b && p.bary[k] != 0)
        sum += p.bary[k] * n.dot(source_.X.row(v).transpose());
    }
    return sum;
  }

  /// Where the line crosses a side of the triangle, computed from the end with the smaller number.
  [[nodiscard]] Vector3d crossing(int side, const std::array<double, 3>& values) const {
    int i = side, j = (side + 1) % 3;
    if (vertices_[idx(i)] > vertices_[idx(j)]) std::swap(i, j);
    const double t = values[idx(i)] / (values[idx(i)] - values[idx(j)]);
    Vector3d bary = Vector3d::Zero();
    bary[i] = 1 - t;
    bary[j] = t;
    return bary;
  }

  static double at(const std::array<double, 3>& values, const ClipCorner& corner) {
    if (corner.vertex >= 0) return values[idx(corner.vertex)];
    // Two products commute exactly, three would not: points of a side have a zero among them.
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += corner.bary[k] != 0 ? corner.bary[k] * values[idx(k)] : 0;
    return sum;
  }

  [[nodiscard]] ClippedFace clip(int face) const {
    ClippedFace polygon;
    polygon.face = face;
    for (int k = 0; k < 3; ++k) {
      polygon.corners.push_back({Vector3d::Unit(k), k, -1, {}, -1});
      polygon.lines.push_back({k, -1, -1});
    }
    for (int k = 0; k < 3 && polygon.corners.size() >= 3; ++k) {
      const int h = 3 * face + k;
      const ClipLine line = edge_line(h);
      const double sign = source_.mesh.from(h) == line.a ? 1 : -1;
      std::array<double, 3> values;
      for (int c = 0; c < 3; ++c) values[idx(c)] = sign * value(line, c);
      cut(polygon, line, values);
    }
    if (polygon.corners.size() < 3) polygon.corners.clear();
    return polygon;
  }

  /// Sutherland & Hodgman 1974, by one line.
  void cut(ClippedFace& polygon, const ClipLine& line, const std::array<double, 3>& values) const {
    ClippedFace kept;
    kept.face = polygon.face;
    const std::size_t n = polygon.corners.size();
    std::vector<double> height;
    height.reserve(n);
    for (const ClipCorner& corner : polygon.corners)
      height.push_back(corner.line == line || has_end(line, corner) ? 0 : at(values, corner));
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = (i + 1) % n;
      const bool in = height[i] >= 0, next_in = height[j] >= 0;
      if (in) {
        kept.corners.push_back(polygon.corners[i]);
        // Behind a corner on the line the polygon may run on along it.
        kept.lines.push_back(next_in ? polygon.lines[i] : line);
      }
      if ((height[i] > 0 && height[j] < 0) || (height[i] < 0 && height[j] > 0)) {
        if (in) kept.lines.back() = polygon.lines[i];
        kept.corners.push_back(meet(polygon.corners[i],
                                    polygon.corners[j],
                                    polygon.lines[i],
                                    line,
                                    values,
                                    height[i] / (height[i] - height[j])));
        kept.lines.push_back(in ? line : polygon.lines[i]);
      }
    }
    polygon = std::move(kept);
  }

  /// Whether the corner is a source vertex at the line's end.
  static bool has_end(const ClipLine& line, const ClipCorner& corner) {
    return corner.source_vertex >= 0 &&
           (corner.source_vertex == line.a || corner.source_vertex == line.b);
  }

  [[nodiscard]] ClipCorner meet(const ClipCorner& from,
                                const ClipCorner& to,
                                const ClipLine& along,
                                const ClipLine& line,
                                const std::array<double, 3>& values,
                                double t) const {
    if (along.side >= 0) return {crossing(along.side, values), -1, along.side, line, -1};
    // Two edges of the face: its corner between them.
    const int shared = along.a == line.a || along.a == line.b ? along.a : along.b;
    return {from.bary + t * (to.bary - from.bary), -1, -1, {}, shared};
  }

  const SphereSource& source_;
  const std::array<SurfacePoint, 3>& points_;
  const std::array<int, 3>& vertices_;
};

}  // namespace

double area_share(const ClippedFace& polygon) {
  double area = 0;
  for (std::size_t c = 1; c + 1 < polygon.corners.size(); ++c)
    area +=
        signed_share(polygon.corners[0].bary, polygon.corners[c].bary, polygon.corners[c + 1].bary);
  return area;
}

Vector3d on_sphere(const SphereSource& source, const SurfacePoint& p) {
  Vector3d y = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) y += p.bary[k] * source.X.row(source.mesh.F(p.face, k)).transpose();
  return y;
}

std::vector<ClippedFace> clip_to_source(const SphereSource& source,
                                        const std::array<SurfacePoint, 3>& points,
                                        const std::array<int, 3>& vertices) {
  return Clipper(source, points, vertices).run();
}

}  // namespace crosspatch
