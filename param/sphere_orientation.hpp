#pragma once

#include <algorithm>

#include "core/types.hpp"

namespace crosspatch {

/// det [a b c] of three points of the unit sphere, computed by differences so that small faces keep
/// their digits; 0 where it is not positive or negative beyond doubt: a face accepted with a
/// positive value is positive in exact arithmetic too.
inline double sphere_orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  // Rounding of the determinant is a few 1e-16 of the product of two edges.
  constexpr double kDoubt = 1e-13;
  const Vector3d u = b - a, v = c - a;
  const double det = a.dot(u.cross(v));
  return std::abs(det) >
                 kDoubt * std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()})
             ? det
             : 0;
}

}  // namespace crosspatch
