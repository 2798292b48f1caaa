#include "transfer/color_space.hpp"

#include <cmath>
#include <vector>

namespace crosspatch {
namespace {

constexpr int kSteps = 65536;

float decode_srgb(float s) {
  return s <= 0.04045F ? s / 12.92F : std::pow((s + 0.055F) / 1.055F, 2.4F);
}

float encode_srgb(float l) {
  return l <= 0.0031308F ? l * 12.92F : 1.055F * std::pow(l, 1 / 2.4F) - 0.055F;
}

/// Linear light of every stored value.
const std::vector<float>& decoded() {
  static const std::vector<float> table = [] {
    std::vector<float> values(kSteps);
    for (int i = 0; i < kSteps; ++i)
      values[static_cast<std::size_t>(i)] = decode_srgb(static_cast<float>(i) / (kSteps - 1));
    return values;
  }();
  return table;
}

/// Stored value of all linear ones.
const std::vector<std::uint16_t>& encoded() {
  static const std::vector<std::uint16_t> table = [] {
    std::vector<std::uint16_t> values(kSteps);
    for (int i = 0; i < kSteps; ++i)
      values[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(
          std::lround(encode_srgb(static_cast<float>(i) / (kSteps - 1)) * (kSteps - 1)));
    return values;
  }();
  return table;
}

}  // namespace

float to_linear_light(std::uint16_t stored, ColorSpace space) {
  if (space == ColorSpace::kSrgb) return decoded()[stored];
  return static_cast<float>(stored) / (kSteps - 1);
}

const std::uint16_t* srgb_values() {
  return encoded().data();
}

std::uint16_t to_stored(std::uint16_t linear, ColorSpace space) {
  return space == ColorSpace::kSrgb ? encoded()[linear] : linear;
}

}  // namespace crosspatch
