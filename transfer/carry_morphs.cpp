#include "transfer/carry_morphs.hpp"

#include <Eigen/LU>
#include <cmath>

#include "core/index.hpp"
#include "transfer/fit_similarity.hpp"

namespace crosspatch {
namespace {

/// Frames are averaged over as many edges around a vertex: differentials jump from one triangle to
/// the next, and a lip should not.
constexpr int kRounds = 4;

/// An orthonormal basis of a triangle, normal last; zero where it has no area.
Eigen::Matrix3d basis(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a).stableNormalized();
  const Vector3d along = (b - a).stableNormalized();
  Eigen::Matrix3d m;
  m << along, normal.cross(along), normal;
  return m;
}

/// The differential of a polygon of the map, completed by its normal: the best affine map of its
/// corners in the planes. Zero where that has no turn.
Eigen::Matrix3d differential(const TriangleMesh& source,
                             const TriangleMesh& target,
                             const SurfaceMap& map,
                             int polygon) {
  const auto corners = [](const TriangleMesh& mesh, int f) {
    return basis(
        mesh.position(mesh.F(f, 0)), mesh.position(mesh.F(f, 1)), mesh.position(mesh.F(f, 2)));
  };
  const Eigen::Matrix3d from = corners(source, map.source_face[idx(polygon)]);
  const Eigen::Matrix3d to = corners(target, map.target_face[idx(polygon)]);
  const int begin = map.polygon_begin[idx(polygon)], end = map.polygon_begin[idx(polygon + 1)];
  Eigen::Matrix3Xd x(3, end - begin), y(3, end - begin);
  for (int i = begin; i < end; ++i) {
    const int q = map.corner[idx(i)];
    x.col(i - begin) = position(source, map.source[idx(q)]);
    y.col(i - begin) = position(target, map.target[idx(q)]);
  }
  const Vector3d x0 = x.rowwise().mean(), y0 = y.rowwise().mean();
  const Eigen::Matrix2Xd u = (from.transpose() * (x.colwise() - x0)).topRows<2>();
  const Eigen::Matrix2Xd v = (to.transpose() * (y.colwise() - y0)).topRows<2>();
  const Eigen::Matrix2d metric = u * u.transpose();
  // Squared sine of the polygon's narrowness: below it the differential is rounding.
  constexpr double kFlat = 1e-12;
  if (!(metric.determinant() > kFlat * metric.trace() * metric.trace()))
    return Eigen::Matrix3d::Zero();
  const Eigen::Matrix2d plane = v * u.transpose() * metric.inverse();
  // The conformal part: of the nearest similarity's turn, and of the area's ratio.
  const Vector2d turn(plane(0, 0) + plane(1, 1), plane(1, 0) - plane(0, 1));
  const double scale = std::sqrt(std::abs(plane.determinant()));
  if (!(turn.norm() > 0) || !std::isfinite(scale)) return Eigen::Matrix3d::Zero();
  const Vector2d unit = turn.normalized();
  Eigen::Matrix3d inner = Eigen::Matrix3d::Identity();
  inner.topLeftCorner<2, 2>() << unit[0], -unit[1], unit[1], unit[0];
  return scale * to * inner * from.transpose();
}

}  // namespace

std::vector<Eigen::Matrix3d> displacement_frames(const TriangleMesh& source,
                                                 const TriangleMesh& target,
                                                 const SurfaceMap& map) {
  const std::size_t vertices = idx(target.vertex_count());
  std::vector<Eigen::Matrix3d> sum(vertices, Eigen::Matrix3d::Zero());
  std::vector<double> weight(vertices, 0.0);
  for (int p = 0; p < map.polygon_count(); ++p) {
    const Eigen::Matrix3d frame = differential(source, target, map, p);
    if (frame.isZero(0)) continue;
    const int f = map.target_face[idx(p)];
    const int begin = map.polygon_begin[idx(p)], end = map.polygon_begin[idx(p + 1)];
    Vector3d normal = Vector3d::Zero(), bary = Vector3d::Zero();
    const auto at = [&](int i) { return position(target, map.target[idx(map.corner[idx(i)])]); };
    for (int i = begin; i < end; ++i) {
      bary += in_face(target, map.target[idx(map.corner[idx(i)])], f).bary / (end - begin);
      if (i >= begin + 2) normal += (at(i - 1) - at(begin)).cross(at(i) - at(begin)) / 2;
    }
    for (int k = 0; k < 3; ++k) {
      const double share = normal.norm() * bary[k];
      sum[idx(target.F(f, k))] += share * frame;
      weight[idx(target.F(f, k))] += share;
    }
  }
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Matrix3d> spread = sum;
    std::vector<double> spread_weight = weight;
    for (int v = 0; v < target.vertex_count(); ++v)
      for_each_outgoing(target, v, [&](int h) {
        const std::size_t u = idx(target.to(h));
        spread[idx(v)] += sum[u];
        spread_weight[idx(v)] += weight[u];
      });
    sum = std::move(spread);
    weight = std::move(spread_weight);
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (!(weight[v] > 0) || !(sum[v].norm() > 0)) {
      sum[v].setIdentity();
      continue;
    }
    // The scale is that of the mean's parts along its own turn.
    const Eigen::Matrix3d mean = sum[v] / weight[v], turn = nearest_turn(mean);
    sum[v] = (turn.transpose() * mean).trace() / 3 * turn;
  }
  return sum;
}

}  // namespace crosspatch
