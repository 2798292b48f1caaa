#include "param/map_quality.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Barycentric coordinates of a face laid out in the plane, counter-clockwise, scaled so that the
/// surface has area 1.
Eigen::Matrix<double, 2, 3> layout(const TriangleMesh& mesh, int face, double scale) {
  const Vector3d a = mesh.position(mesh.F(face, 0));
  const Vector3d u = (mesh.position(mesh.F(face, 1)) - a) * scale,
                 v = (mesh.position(mesh.F(face, 2)) - a) * scale;
  const double length = std::max(u.norm(), 1e-300);
  Eigen::Matrix<double, 2, 3> corners;
  corners << 0, length, v.dot(u) / length, 0, 0, u.cross(v).norm() / length;
  return corners;
}

Eigen::Matrix2d edges(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  Eigen::Matrix2d e;
  e << b - a, c - a;
  return e;
}

/// A triangle of the common subdivision.
struct Piece {
  double energy, weight;
  double stretch;
};

/// A polygon laid flat on both surfaces, cut into pieces.
struct Polygon {
  double source_area = 0, target_area = 0;  ///< signed
  std::vector<Piece> pieces;                ///< those that have area
};

Polygon measure_polygon(const SurfaceMap& map,
                        int p,
                        const TriangleMesh& source,
                        const TriangleMesh& target,
                        double source_scale,
                        double target_scale) {
  Polygon polygon;
  const int fa = map.source_face[at(p)], fb = map.target_face[at(p)];
  const auto A = layout(source, fa, source_scale), B = layout(target, fb, target_scale);
  std::vector<Vector2d> a, b;
  for (int i = map.polygon_begin[at(p)]; i < map.polygon_begin[at(p) + 1]; ++i) {
    const size_t q = at(map.corner[at(i)]);
    a.push_back(A * in_face(source, map.source[q], fa).bary);
    b.push_back(B * in_face(target, map.target[q], fb).bary);
  }
  for (size_t i = 1; i + 1 < a.size(); ++i) {
    const Eigen::Matrix2d E = edges(a[0], a[i], a[i + 1]), G = edges(b[0], b[i], b[i + 1]);
    const double da = E.determinant() / 2, db = G.determinant() / 2;
    polygon.source_area += da;
    polygon.target_area += db;
    constexpr double kNothing = 1e-16;
    if (!(da > kNothing && db > kNothing)) continue;
    const Vector2d s = Eigen::JacobiSVD<Eigen::Matrix2d>(G * E.inverse()).singularValues();
    const double energy = s[0] * s[0] + s[1] * s[1] + 1 / (s[0] * s[0]) + 1 / (s[1] * s[1]);
    polygon.pieces.push_back({energy, (da + db) / 2, std::max(s[0], 1 / s[1])});
  }
  return polygon;
}

double percentile(const std::vector<Piece>& sorted, double share) {
  double total = 0, sum = 0;
  for (const Piece& p : sorted) total += p.weight;
  for (const Piece& p : sorted)
    if ((sum += p.weight) >= share * total) return p.energy;
  return sorted.empty() ? 0 : sorted.back().energy;
}

}  // namespace

MapQuality measure_map(const SurfaceMap& map,
                       const TriangleMesh& source,
                       const TriangleMesh& target) {
  // Areas below this share of the mean face are rounding of the crossings' coordinates.
  constexpr double kRounding = 1e-9;
  const double source_scale = 1 / std::sqrt(total_area(source)),
               target_scale = 1 / std::sqrt(total_area(target));
  const double source_tolerance = kRounding / source.face_count(),
               target_tolerance = kRounding / target.face_count();
  MapQuality quality;
  std::vector<Piece> pieces;
  double weight_sum = 0;
  for (int p = 0; p < map.polygon_count(); ++p) {
    const Polygon polygon = measure_polygon(map, p, source, target, source_scale, target_scale);
    const double area_a = polygon.source_area, area_b = polygon.target_area;
    for (const Piece& piece : polygon.pieces) {
      pieces.push_back(piece);
      quality.mean += piece.energy * piece.weight;
      weight_sum += piece.weight;
      quality.worst_stretch = std::max(quality.worst_stretch, piece.stretch);
    }
    quality.flipped += area_a < -source_tolerance || area_b < -target_tolerance ? 1 : 0;
    quality.source_coverage += std::max(area_a, 0.0);
    quality.target_coverage += std::max(area_b, 0.0);
  }
  if (weight_sum > 0) quality.mean /= weight_sum;
  std::sort(pieces.begin(), pieces.end(), [](const Piece& x, const Piece& y) {
    return x.energy < y.energy;
  });
  quality.median = percentile(pieces, 0.5);
  quality.percentile_90 = percentile(pieces, 0.9);
  quality.percentile_99 = percentile(pieces, 0.99);
  return quality;
}

VertexDistortion vertex_distortion(const SurfaceMap& map,
                                   const TriangleMesh& source,
                                   const TriangleMesh& target) {
  const double source_scale = 1 / std::sqrt(total_area(source)),
               target_scale = 1 / std::sqrt(total_area(target));
  VertexDistortion sum{Eigen::VectorXd::Zero(source.vertex_count()),
                       Eigen::VectorXd::Zero(target.vertex_count())};
  VertexDistortion weight = sum;
  for (int p = 0; p < map.polygon_count(); ++p)
    for (const Piece& piece :
         measure_polygon(map, p, source, target, source_scale, target_scale).pieces)
      for (int k = 0; k < 3; ++k) {
        const int a = source.F(map.source_face[at(p)], k), b = target.F(map.target_face[at(p)], k);
        sum.source[a] += piece.energy * piece.weight;
        weight.source[a] += piece.weight;
        sum.target[b] += piece.energy * piece.weight;
        weight.target[b] += piece.weight;
      }
  const auto mean = [](const Eigen::VectorXd& s, const Eigen::VectorXd& w) {
    Eigen::VectorXd m = Eigen::VectorXd::Constant(s.size(), 4.0);  // an isometry
    for (Eigen::Index i = 0; i < m.size(); ++i)
      if (w[i] > 0) m[i] = s[i] / w[i];
    return m;
  };
  return {mean(sum.source, weight.source), mean(sum.target, weight.target)};
}

}  // namespace crosspatch
