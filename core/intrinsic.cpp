#include "core/intrinsic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// The length of the other diagonal of the two faces at h: they are laid out in the plane with h on
/// the x axis from the origin.
double other_diagonal(const IntrinsicMesh& mesh, int h) {
  const int t = mesh.twin[idx(h)];
  const double base = mesh.length[idx(h)];
  const auto apex = [&](double from_origin, double area) {
    const double y = 2 * area / base;
    return Vector2d(std::sqrt(std::max(0.0, from_origin * from_origin - y * y)), y);
  };
  Vector2d up = apex(mesh.length[idx(prev(h))], face_area(mesh, face_of(h)));
  Vector2d down = apex(mesh.length[idx(next(t))], face_area(mesh, face_of(t)));
  // The square root loses the sign of x, which is that of the cosine at the origin.
  const auto obtuse_at_origin = [&](double adjacent, double opposite) {
    return adjacent * adjacent + base * base < opposite * opposite;
  };
  if (obtuse_at_origin(mesh.length[idx(prev(h))], mesh.length[idx(next(h))])) up.x() *= -1;
  if (obtuse_at_origin(mesh.length[idx(next(t))], mesh.length[idx(prev(t))])) down.x() *= -1;
  return (up - Vector2d(down.x(), -down.y())).norm();
}

/// Replaces the edge of h by the other diagonal of its two faces, which keep their numbers.
void flip(IntrinsicMesh& mesh, int h) {
  const int t = mesh.twin[idx(h)];
  const double length = other_diagonal(mesh, h);
  const int k = mesh.from[idx(prev(h))], m = mesh.from[idx(prev(t))];
  // Faces (i, j, k) and (j, i, m) become (m, k, i) and (k, m, j); the four outer sides move.
  const std::array<int, 4> old_side{prev(h), next(t), prev(t), next(h)};
  const std::array<int, 4> new_side{next(h), prev(h), next(t), prev(t)};
  std::array<int, 4> vertex{}, twin{};
  std::array<double, 4> side_length{};
  for (size_t s = 0; s < 4; ++s) {
    vertex[s] = mesh.from[idx(old_side[s])];
    twin[s] = mesh.twin[idx(old_side[s])];
    side_length[s] = mesh.length[idx(old_side[s])];
  }
  for (size_t s = 0; s < 4; ++s) {
    // An outer side may be glued to another one of the four.
    const auto moved = std::find(old_side.begin(), old_side.end(), twin[s]);
    const int partner = moved == old_side.end() ? twin[s] : new_side[idx(moved - old_side.begin())];
    mesh.from[idx(new_side[s])] = vertex[s];
    mesh.length[idx(new_side[s])] = side_length[s];
    mesh.twin[idx(new_side[s])] = partner;
    if (partner >= 0) mesh.twin[idx(partner)] = new_side[s];
  }
  mesh.from[idx(h)] = m;
  mesh.from[idx(t)] = k;
  mesh.length[idx(h)] = mesh.length[idx(t)] = length;
}

bool is_delaunay(const IntrinsicMesh& mesh, int h) {
  const int t = mesh.twin[idx(h)];
  if (t < 0 || face_of(t) == face_of(h)) return true;
  // Slack for rounding, so that cocircular points do not flip for ever.
  constexpr double kSlack = 1e-9;
  return cotangent(mesh, h) + cotangent(mesh, t) >= -kSlack;
}

}  // namespace

IntrinsicMesh intrinsic_mesh(const TriangleMesh& mesh) {
  IntrinsicMesh result{mesh.vertex_count(), {}, mesh.twin, {}};
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    result.from.push_back(mesh.from(h));
    // Ordered ends, so that both sides get the same bits.
    const int a = std::min(mesh.from(h), mesh.to(h)), b = std::max(mesh.from(h), mesh.to(h));
    result.length.push_back((mesh.position(b) - mesh.position(a)).norm());
  }
  return result;
}

double mollify(IntrinsicMesh& mesh, double relative_slack) {
  const double mean = std::accumulate(mesh.length.begin(), mesh.length.end(), 0.0) /
                      std::max(1, mesh.halfedge_count());
  double added = 0;
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    added = std::max(added,
                     relative_slack * mean + mesh.length[idx(h)] - mesh.length[idx(next(h))] -
                         mesh.length[idx(prev(h))]);
  for (double& length : mesh.length) length += added;
  return added;
}

int make_delaunay(IntrinsicMesh& mesh) {
  std::vector<int> stack;
  std::vector<bool> waiting(idx(mesh.halfedge_count()), false);
  const auto push = [&](int h) {
    const int t = mesh.twin[idx(h)];
    if (t < 0) return;
    const int side = std::min(h, t);
    if (waiting[idx(side)]) return;
    waiting[idx(side)] = true;
    stack.push_back(side);
  };
  for (int h = mesh.halfedge_count() - 1; h >= 0; --h) push(h);
  int flips = 0;
  // Flipping ends by itself in exact arithmetic; the bound only guards against rounding.
  const long bound = 50L * mesh.halfedge_count();
  while (!stack.empty() && flips < bound) {
    const int h = stack.back();
    stack.pop_back();
    waiting[idx(h)] = false;
    if (mesh.twin[idx(h)] < 0 || is_delaunay(mesh, h)) continue;
    flip(mesh, h);
    ++flips;
    for (const int side : {h, mesh.twin[idx(h)]}) {
      push(next(side));
      push(prev(side));
    }
  }
  return flips;
}

double face_area(const IntrinsicMesh& mesh, int f) {
  std::array<double, 3> l{
      mesh.length[idx(3 * f)], mesh.length[idx(3 * f + 1)], mesh.length[idx(3 * f + 2)]};
  std::sort(l.begin(), l.end(), std::greater<>());
  const auto [a, b, c] = l;
  const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
  return 0.25 * std::sqrt(std::max(0.0, product));
}

double cotangent(const IntrinsicMesh& mesh, int h) {
  const double a = mesh.length[idx(h)];
  const double b = mesh.length[idx(next(h))], c = mesh.length[idx(prev(h))];
  return (b * b + c * c - a * a) / (4 * face_area(mesh, face_of(h)));
}

}  // namespace crosspatch
