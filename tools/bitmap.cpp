#include "tools/bitmap.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace crosspatch {
namespace {

using std::size_t;

size_t offset(const Bitmap& bitmap, int x, int y) {
  assert(x >= 0 && x < bitmap.width && y >= 0 && y < bitmap.height);
  return 4 * (static_cast<size_t>(y) * static_cast<size_t>(bitmap.width) + static_cast<size_t>(x));
}

double decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// The linear values halfway (in sRGB) between neighbouring 8-bit values, so that encoding is a
/// search and agrees exactly with rounding.
std::array<float, 255> make_thresholds() {
  std::array<float, 255> thresholds{};
  for (size_t i = 0; i < thresholds.size(); ++i)
    thresholds[i] = static_cast<float>(decode((static_cast<double>(i) + 0.5) / 255));
  return thresholds;
}

std::array<float, 256> make_linear() {
  std::array<float, 256> linear{};
  for (size_t i = 0; i < linear.size(); ++i)
    linear[i] = static_cast<float>(decode(static_cast<double>(i) / 255));
  return linear;
}

}  // namespace

float srgb_to_linear(std::uint8_t value) {
  static const std::array<float, 256> linear = make_linear();
  return linear[value];
}

std::uint8_t linear_to_srgb(float value) {
  static const std::array<float, 255> thresholds = make_thresholds();
  return static_cast<std::uint8_t>(std::upper_bound(thresholds.begin(), thresholds.end(), value) -
                                   thresholds.begin());
}

Bitmap make_bitmap(int width, int height, const Color& fill) {
  Bitmap bitmap{width, height, {}};
  bitmap.rgba.resize(4 * static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) set_pixel(bitmap, x, y, fill);
  return bitmap;
}

Color pixel(const Bitmap& bitmap, int x, int y) {
  const std::uint8_t* p = &bitmap.rgba[offset(bitmap, x, y)];
  return {srgb_to_linear(p[0]), srgb_to_linear(p[1]), srgb_to_linear(p[2])};
}

void set_pixel(Bitmap& bitmap, int x, int y, const Color& color) {
  std::uint8_t* p = &bitmap.rgba[offset(bitmap, x, y)];
  for (int k = 0; k < 3; ++k) p[k] = linear_to_srgb(color[k]);
  p[3] = 255;
}

}  // namespace crosspatch
