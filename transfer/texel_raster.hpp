#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/types.hpp"

namespace crosspatch {

/// Twice the signed area of a triangle in the plane.
inline double doubled_area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Texels [left, right] of a row, and the barycentric coordinates of their centres: at_zero + x
/// per_x.
struct TexelSpan {
  int y = 0, left = 0, right = -1;
  Vector3d at_zero, per_x;
};

/// Calls visit(span) for the rows of texels whose centres (x + 1/2, y + 1/2) lie in the triangle
/// `corner` (in texels, either orientation) or no further than `margin` texels from the line of
/// one of its sides; rows in [first_row, end_row) and columns in [0, width) only. Spans without
/// texels are passed over. Triangles without area have none.
template <class Visit>
void for_each_span(const std::array<Vector2d, 3>& corner,
                   double margin,
                   std::array<int, 2> rows,
                   int width,
                   Visit visit) {
  const double area = doubled_area(corner[0], corner[1], corner[2]);
  if (area == 0) return;
  const auto [low_y, high_y] = std::minmax({corner[0][1], corner[1][1], corner[2][1]});
  const double top = std::max<double>(rows[0], std::ceil(low_y - margin - 0.5));
  const double bottom = std::min<double>(rows[1] - 1, std::floor(high_y + margin - 0.5));
  if (top > bottom) return;
  const auto [low_x, high_x] = std::minmax({corner[0][0], corner[1][0], corner[2][0]});
  const double first = std::max(0.0, low_x - margin - 0.5);
  const double last = std::min<double>(width - 1, high_x + margin - 0.5);
  // Weight k is the height over the side opposite to corner k, as a share of the triangle's:
  // at[k] + x per_x[k] + y per_y[k]. Row y crosses the side, moved out by the margin, at x =
  // crossing[k] + y slope[k].
  Vector3d at, per_y;
  std::array<double, 3> crossing{}, slope{}, slack{};
  TexelSpan span;
  for (int k = 0; k < 3; ++k) {
    const std::size_t i = static_cast<std::size_t>(k);
    const Vector2d &from = corner[(i + 1) % 3], side = corner[(i + 2) % 3] - from;
    const Vector2d gradient = Vector2d(-side[1], side[0]) / area;
    span.per_x[k] = gradient[0];
    per_y[k] = gradient[1];
    at[k] = gradient.dot(Vector2d(0.5, 0.5) - from);
    slack[i] = -margin * gradient.norm();
    crossing[i] = (slack[i] - at[k]) / gradient[0];
    slope[i] = -gradient[1] / gradient[0];
  }
  for (double y = top; y <= bottom; ++y) {
    double left = first, right = last;
    span.at_zero = at + y * per_y;
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = crossing[k] + y * slope[k];
      const int i = static_cast<int>(k);
      if (span.per_x[i] > 0)
        left = std::max(left, x);
      else if (span.per_x[i] < 0)
        right = std::min(right, x);
      else if (span.at_zero[i] < slack[k])
        right = -1;
    }
    if (left > right) continue;
    span.y = static_cast<int>(y);
    span.left = static_cast<int>(left);  // rounded up below, as the right end is rounded down
    if (span.left < left) ++span.left;
    span.right = static_cast<int>(right);
    if (span.left <= span.right) visit(std::as_const(span));
  }
}

/// Calls visit(x, y, bary) for each texel of the spans of for_each_span.
template <class Visit>
void for_each_texel(const std::array<Vector2d, 3>& corner,
                    double margin,
                    std::array<int, 2> rows,
                    int width,
                    Visit visit) {
  for_each_span(corner, margin, rows, width, [&](const TexelSpan& span) {
    for (int x = span.left; x <= span.right; ++x)
      visit(x, span.y, Vector3d(span.at_zero + x * span.per_x));
  });
}

}  // namespace crosspatch
