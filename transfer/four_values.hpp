#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>

namespace crosspatch {

// Four values at once: compilers do not find these instructions behind Eigen's conversions, and
// reading and writing texels is most of the time that a bake takes.
using FourFloats = float __attribute__((vector_size(16)));
using FourInts = std::int32_t __attribute__((vector_size(16)));
using FourShorts = std::uint16_t __attribute__((vector_size(8)));

inline FourFloats load_four(const std::uint16_t* p) {
  FourShorts narrow;
  std::memcpy(&narrow, p, sizeof narrow);
  return __builtin_convertvector(__builtin_convertvector(narrow, FourInts), FourFloats);
}

/// Rounds to the nearest; what is outside of [0, 65535] goes to its ends.
inline FourShorts rounded(const FourFloats& values) {
  const FourFloats none{0, 0, 0, 0}, most{65535, 65535, 65535, 65535};
  FourFloats inside = values > none ? values : none;
  inside = inside < most ? inside : most;
  return __builtin_convertvector(__builtin_convertvector(inside + 0.5F, FourInts), FourShorts);
}

/// The first three or all four.
inline void store_values(const FourFloats& values, int channels, std::uint16_t* p) {
  const FourShorts narrow = rounded(values);
  if (channels == 4)
    std::memcpy(p, &narrow, sizeof narrow);
  else
    std::memcpy(p, &narrow, 3 * sizeof *p);
}

inline Eigen::Array4f to_array(const FourFloats& v) {
  return {v[0], v[1], v[2], v[3]};
}

}  // namespace crosspatch
