#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/types.hpp"

namespace crosspatch {

/// Twice the signed area of a triangle in the plane.
inline double doubled_area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Calls visit(x, y, bary) for each texel whose centre (x + 1/2, y + 1/2) lies in the triangle
/// `corner` (in texels, either orientation) or no further than `margin` texels from the line of
/// one of its sides, row by row; rows in [first_row, end_row) and columns in [0, width) only.
/// Triangles without area have no texels.
template <class Visit>
void for_each_texel(const std::array<Vector2d, 3>& corner,
                    double margin,
                    std::array<int, 2> rows,
                    int width,
                    Visit visit) {
  const double area = doubled_area(corner[0], corner[1], corner[2]);
  if (area == 0) return;
  // Weight k is the height over the side opposite to corner k, as a share of the triangle's.
  std::array<Vector2d, 3> gradient;
  std::array<double, 3> slack{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector2d side = corner[(k + 2) % 3] - corner[(k + 1) % 3];
    gradient[k] = Vector2d(-side[1], side[0]) / area;
    slack[k] = -margin * gradient[k].norm();
  }
  const auto [low_y, high_y] = std::minmax({corner[0][1], corner[1][1], corner[2][1]});
  const auto [low_x, high_x] = std::minmax({corner[0][0], corner[1][0], corner[2][0]});
  const double top = std::max<double>(rows[0], std::ceil(low_y - margin - 0.5));
  const double bottom = std::min<double>(rows[1] - 1, std::floor(high_y + margin - 0.5));
  for (double y = top; y <= bottom; ++y) {
    double left = std::max(0.0, std::ceil(low_x - margin - 0.5));
    double right = std::min<double>(width - 1, std::floor(high_x + margin - 0.5));
    std::array<double, 3> at_zero{};
    for (std::size_t k = 0; k < 3 && left <= right; ++k) {
      const Vector2d& g = gradient[k];
      const Vector2d from = Vector2d(0.5, y + 0.5) - corner[(k + 1) % 3];
      at_zero[k] = g.dot(from);
      if (g[0] > 0)
        left = std::max(left, std::ceil((slack[k] - at_zero[k]) / g[0]));
      else if (g[0] < 0)
        right = std::min(right, std::floor((slack[k] - at_zero[k]) / g[0]));
      else if (at_zero[k] < slack[k])
        right = -1;
    }
    for (double x = left; x <= right; ++x)
      visit(static_cast<int>(x),
            static_cast<int>(y),
            Vector3d(at_zero[0] + x * gradient[0][0],
                     at_zero[1] + x * gradient[1][0],
                     at_zero[2] + x * gradient[2][0]));
  }
}

}  // namespace crosspatch
