// Colours computed in OKLab (Bjorn Ottosson, "A perceptual color space for image processing",
// 2020), whose axes are even to the eye.
#include "tools/palette.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace crosspatch {
namespace {

Vector3d oklab_to_linear(double L, double a, double b) {
  const double l = std::pow(L + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(L - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(L - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

Color oklch(double lightness, double chroma, double hue_radians) {
  Vector3d rgb;
  // 5 % steps: the first colour inside the gamut has at least 95 % of the possible chroma.
  for (double c = chroma;; c = c < 1e-3 ? 0 : 0.95 * c) {
    rgb = oklab_to_linear(lightness, c * std::cos(hue_radians), c * std::sin(hue_radians));
    if (c == 0 || (rgb.minCoeff() >= 0 && rgb.maxCoeff() <= 1)) break;
  }
  return rgb.cwiseMax(0).cwiseMin(1).cast<float>();
}

Color field_color(double t) {
  if (std::isnan(t)) return neutral_color();
  t = std::clamp(t, 0.0, 1.0);
  // From violet (305 degrees) backwards round the hue circle to yellow (105 degrees).
  return oklch(0.28 + 0.62 * t, 0.12 + 0.05 * t, (305 - 200 * t) * kDegree);
}

Color heat_color(double t) {
  if (std::isnan(t)) return neutral_color();
  t = std::clamp(t, 0.0, 1.0);
  return oklch(0.97 - 0.62 * t, 0.24 * std::sqrt(t), (75 - 50 * t) * kDegree);
}

double distortion_place(double energy) {
  return std::log(std::max(energy, 4.0) / 4) / std::log(25.0);
}

Color category_color(int i) {
  // The golden angle never repeats a hue; three lightness levels tell close hues apart.
  constexpr double kGoldenAngle = std::numbers::pi * (3 - 2.2360679774997896);
  constexpr double kLightness[3] = {0.72, 0.56, 0.84};
  return oklch(kLightness[i % 3], 0.15, i * kGoldenAngle);
}

Color position_color(const Vector3d& unit_position) {
  // 8-bit sRGB levels 25 .. 230 keep shading visible at both ends.
  Color color;
  for (int k = 0; k < 3; ++k)
    color[k] = srgb_to_linear(
        static_cast<std::uint8_t>(25 + std::lround(205 * std::clamp(unit_position[k], 0.0, 1.0))));
  return color;
}

}  // namespace crosspatch
