// Filter: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", 1997. The fallback scales all coordinates by one power of two to integers, so that
// no expansion can overflow or underflow.
#include "param/predicates.hpp"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

namespace crosspatch {
namespace {

using Integer = boost::multiprecision::cpp_int;

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

/// The numbers times 2^-e, e the smallest exponent of a last bit among them: exact integers.
template <std::size_t N>
std::array<Integer, N> as_integers(const std::array<double, N>& x) {
  constexpr int kDigits = std::numeric_limits<double>::digits;
  std::array<std::int64_t, N> mantissa{};
  std::array<int, N> exponent{};
  int lowest = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < N; ++i) {
    assert(std::isfinite(x[i]));
    mantissa[i] = static_cast<std::int64_t>(std::ldexp(std::frexp(x[i], &exponent[i]), kDigits));
    if (mantissa[i] != 0) lowest = std::min(lowest, exponent[i]);
  }
  std::array<Integer, N> r;
  for (std::size_t i = 0; i < N; ++i) {
    r[i] = mantissa[i];
    if (mantissa[i] != 0) r[i] <<= exponent[i] - lowest;
  }
  return r;
}

int orient2d_exact(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const auto [ax, ay, bx, by, cx, cy] = as_integers<6>({a.x(), a.y(), b.x(), b.y(), c.x(), c.y()});
  const Integer det = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx);
  return det.sign();
}

int orient_sphere_exact(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto [ax, ay, az, bx, by, bz, cx, cy, cz] =
      as_integers<9>({a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), c.x(), c.y(), c.z()});
  const Integer det =
      ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  return det.sign();
}

}  // namespace

int orient2d(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double acx = a.x() - c.x(), acy = a.y() - c.y();
  const double bcx = b.x() - c.x(), bcy = b.y() - c.y();
  // A difference of doubles is zero only if they are equal, so these zeros are exact.
  if ((acx == 0 || bcy == 0) && (acy == 0 || bcx == 0)) return 0;
  const double left = acx * bcy, right = acy * bcx;
  const double det = left - right, size = std::abs(left) + std::abs(right);
  // Shewchuk's bound is (3 + 16 u) u size. Below the size asked for, an underflow (error 2^-1075)
  // might matter; an overflow makes `size` infinite.
  constexpr double kBound = 4 * kUnitRoundoff, kSmallestSize = 1e-280;
  if (size > kSmallestSize && std::isfinite(size) && std::abs(det) > kBound * size)
    return det > 0 ? 1 : -1;
  return orient2d_exact(a, b, c);
}

int orient_sphere(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double yz = b.y() * c.z(), zy = b.z() * c.y();
  const double zx = b.z() * c.x(), xz = b.x() * c.z();
  const double xy = b.x() * c.y(), yx = b.y() * c.x();
  const double det = a.x() * (yz - zy) + a.y() * (zx - xz) + a.z() * (xy - yx);
  const double size = std::abs(a.x()) * (std::abs(yz) + std::abs(zy)) +
                      std::abs(a.y()) * (std::abs(zx) + std::abs(xz)) +
                      std::abs(a.z()) * (std::abs(xy) + std::abs(yx));
  // Five roundings lie on each of the six products: gamma_5 < 6 u; the rest of the 8 covers `size`
  // itself. In the range asked for no underflow (2^-1075 times |a|) reaches the bound.
  constexpr double kBound = 8 * kUnitRoundoff, kSmallestSize = 1e-180, kLargest = 1e100;
  const double largest =
      std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
  if (size > kSmallestSize && largest < kLargest && std::abs(det) > kBound * size)
    return det > 0 ? 1 : -1;
  return orient_sphere_exact(a, b, c);
}

}  // namespace crosspatch
