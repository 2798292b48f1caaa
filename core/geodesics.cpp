#include "core/geodesics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Lengths of all half-edges, shared by the fronts of one mesh.
std::vector<double> halfedge_lengths(const TriangleMesh& mesh) {
  std::vector<double> lengths(idx(mesh.halfedge_count()));
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    lengths[idx(h)] = (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).norm();
  return lengths;
}

/// Height above the x axis of a triangle over the side [0, base] with the other sides a (from 0)
/// and b, and the foot of that height; false if there is none.
bool place_apex(double base, double a, double b, Vector2d& apex) {
  const double x = (a * a - b * b + base * base) / (2 * base);
  const double y2 = a * a - x * x;
  if (!(y2 >= 0)) return false;
  apex = {x, std::sqrt(y2)};
  return true;
}

/// Distance at the corner opposite to a side of length `base` whose ends know their distances d0
/// and d1; a and b are the lengths from those ends to the corner. Infinite when the straight line
/// from the unfolded source does not cross the side.
double distance_across(double base, double a, double b, double d0, double d1) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Vector2d corner, source;
  if (!(base > 0) || !place_apex(base, a, b, corner) || !place_apex(base, d0, d1, source))
    return kNone;
  const double height = corner.y() + source.y();
  if (!(height > 0)) return kNone;
  const double crossing = source.x() + (corner.x() - source.x()) * source.y() / height;
  if (crossing < 0 || crossing > base) return kNone;
  return std::hypot(corner.x() - source.x(), height);
}

void run_front(const TriangleMesh& mesh,
               const std::vector<double>& lengths,
               const std::vector<int>& sources,
               Eigen::Ref<Eigen::VectorXd> distance) {
  distance.setConstant(std::numeric_limits<double>::infinity());
  std::vector<bool> settled(idx(mesh.vertex_count()), false);
  using Entry = std::pair<double, int>;  // ties by vertex index
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  const auto offer = [&](int v, double d) {
    if (settled[idx(v)] || !(d < distance[v])) return;
    distance[v] = d;
    front.emplace(d, v);
  };
  for (const int v : sources) offer(v, 0);
  while (!front.empty()) {
    const int v = front.top().second;
    front.pop();
    if (settled[idx(v)]) continue;
    settled[idx(v)] = true;
    const double dv = distance[v];
    for_each_outgoing(mesh, v, [&](int h) {
      const int a = mesh.to(h), b = mesh.tip(h);
      const double va = lengths[idx(h)], ab = lengths[idx(next(h))], bv = lengths[idx(prev(h))];
      offer(a, dv + va);
      offer(b, dv + bv);
      if (settled[idx(a)]) offer(b, distance_across(va, bv, ab, dv, distance[a]));
      if (settled[idx(b)]) offer(a, distance_across(bv, va, ab, dv, distance[b]));
      // The next triangle over the far side is reached by unfolding when v sees it as a wedge.
      const int t = mesh.twin[idx(next(h))];
      if (t < 0) return;
      const double ac = lengths[idx(next(t))], cb = lengths[idx(prev(t))];
      offer(mesh.tip(t), dv + distance_across(ab, cb, ac, bv, va));
    });
  }
}

}  // namespace

Eigen::MatrixXd geodesic_distances(const TriangleMesh& mesh, const std::vector<int>& sources) {
  const std::vector<double> lengths = halfedge_lengths(mesh);
  Eigen::MatrixXd result(mesh.vertex_count(), static_cast<Eigen::Index>(sources.size()));
  for (size_t j = 0; j < sources.size(); ++j) {
    assert(sources[j] >= 0 && sources[j] < mesh.vertex_count());
    run_front(mesh, lengths, {sources[j]}, result.col(static_cast<Eigen::Index>(j)));
  }
  return result;
}

Eigen::VectorXd geodesic_distance_to_set(const TriangleMesh& mesh,
                                         const std::vector<int>& sources) {
  Eigen::VectorXd result(mesh.vertex_count());
  run_front(mesh, halfedge_lengths(mesh), sources, result);
  return result;
}

}  // namespace crosspatch
