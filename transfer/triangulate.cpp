#include "transfer/triangulate.hpp"

#include <algorithm>

namespace crosspatch {
namespace {

// Rounding of signed_area, whose terms are products of three weights in [0, 1]; thinner triangles
// have no sure orientation.
constexpr double kRounding = 1e-13;

struct Corners {
  const std::vector<Vector3d>& bary;
  std::vector<Vector2d> xy;
};

bool holds(const Corners& c, const std::array<int, 3>& ear, int q) {
  const auto point = [&](int i) -> const Vector3d& { return c.bary[static_cast<std::size_t>(i)]; };
  for (std::size_t k = 0; k < 3; ++k)
    if (signed_area(point(ear[k]), point(ear[(k + 1) % 3]), point(q)) < -kRounding) return false;
  return true;
}

/// Area over longest side squared: largest for the equilateral triangle, 0 for a flat one.
double shape(const Corners& c, const std::array<int, 3>& ear) {
  const Vector2d& a = c.xy[static_cast<std::size_t>(ear[0])];
  const Vector2d& b = c.xy[static_cast<std::size_t>(ear[1])];
  const Vector2d& d = c.xy[static_cast<std::size_t>(ear[2])];
  const Vector2d u = b - a, v = d - a;
  const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (d - b).squaredNorm()});
  return longest > 0 ? (u[0] * v[1] - u[1] * v[0]) / longest : 0;
}

/// Position in `left` of the tip of the best ear, or -1.
int best_ear(const Corners& c, const std::vector<int>& left) {
  const int n = static_cast<int>(left.size());
  const auto corner = [&](int i) { return left[static_cast<std::size_t>((i + n) % n)]; };
  int best = -1;
  double best_shape = 0;
  for (int i = 0; i < n; ++i) {
    const std::array<int, 3> ear{corner(i - 1), corner(i), corner(i + 1)};
    if (signed_area(c.bary[static_cast<std::size_t>(ear[0])],
                    c.bary[static_cast<std::size_t>(ear[1])],
                    c.bary[static_cast<std::size_t>(ear[2])]) <= kRounding)
      continue;
    const double s = shape(c, ear);
    if (s <= best_shape) continue;
    bool empty = true;
    for (int j = 2; j < n - 1 && empty; ++j) empty = !holds(c, ear, corner(i + j));
    if (!empty) continue;
    best = i;
    best_shape = s;
  }
  return best;
}

}  // namespace

double signed_area(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + b[0] * (c[1] * a[2] - c[2] * a[1]) +
         c[0] * (a[1] * b[2] - a[2] * b[1]);
}

std::vector<std::array<int, 3>> triangulate(const std::vector<Vector3d>& polygon,
                                            const std::array<Vector2d, 3>& frame) {
  Corners c{polygon, {}};
  for (const Vector3d& b : polygon)
    c.xy.emplace_back(b[0] * frame[0] + b[1] * frame[1] + b[2] * frame[2]);
  std::vector<int> left(polygon.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  std::vector<std::array<int, 3>> triangles;
  while (left.size() >= 3) {
    const int tip = best_ear(c, left);
    if (tip < 0) return {};
    const std::size_t n = left.size(), i = static_cast<std::size_t>(tip);
    triangles.push_back({left[(i + n - 1) % n], left[i], left[(i + 1) % n]});
    left.erase(left.begin() + tip);
  }
  return triangles;
}

std::array<Vector2d, 3> lay_flat(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d u = b - a, v = c - a;
  const double length = u.norm();
  if (length == 0) return {Vector2d(0, 0), Vector2d(0, 0), Vector2d(0, v.norm())};
  return {Vector2d(0, 0), Vector2d(length, 0), Vector2d(u.dot(v), u.cross(v).norm()) / length};
}

}  // namespace crosspatch
