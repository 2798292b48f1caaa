#pragma once

#include <cstdint>

namespace crosspatch {

/// What stored values mean.
enum class ColorSpace {
  kSrgb,    ///< IEC 61966-2-1: base colour and emission
  kLinear,  ///< everything else
};

/// Linear light in [0, 1] of a stored 16-bit value.
float to_linear_light(std::uint16_t stored, ColorSpace space);

/// The nearest stored 16-bit value of linear light given in 65535ths.
std::uint16_t to_stored(std::uint16_t linear, ColorSpace space);

/// to_stored for sRGB as a table of 65536 entries.
const std::uint16_t* srgb_values();

}  // namespace crosspatch
