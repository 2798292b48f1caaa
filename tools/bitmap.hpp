#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace crosspatch {

/// Linear-light RGB; 1 is the brightest a screen shows.
using Color = Eigen::Vector3f;

/// An 8-bit picture: sRGB-encoded colour and plain alpha, rows from the top.
struct Bitmap {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 width height
};

/// A bitmap filled with an opaque colour.
Bitmap make_bitmap(int width, int height, const Color& fill);

/// The pixel's colour, decoded to linear light. Precondition: inside the bitmap.
Color pixel(const Bitmap& bitmap, int x, int y);
/// Sets the pixel, opaque, clamped to what 8 bits hold. Precondition: inside the bitmap.
void set_pixel(Bitmap& bitmap, int x, int y, const Color& color);

/// Linear light of an 8-bit sRGB value (IEC 61966-2-1).
float srgb_to_linear(std::uint8_t value);
/// The nearest 8-bit sRGB value, clamped.
std::uint8_t linear_to_srgb(float value);

}  // namespace crosspatch
