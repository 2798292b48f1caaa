#pragma once

#include "core/types.hpp"
#include "tools/bitmap.hpp"

namespace crosspatch {

/// The colour of OKLCh coordinates (Ottosson 2020): lightness in [0, 1], chroma, hue in radians.
/// Chroma is lowered until the colour fits into sRGB.
Color oklch(double lightness, double chroma, double hue_radians);

/// Perceptual map of [0, 1], clamped, for scalar fields: lightness grows evenly from dark violet
/// over blue and green to yellow, so that it also reads without colour. NaN is grey.
Color field_color(double t);

/// Perceptual map for distortion: white at 0, over orange, to dark red at 1 and beyond.
Color heat_color(double t);

/// The place of a symmetric Dirichlet energy on that scale: 0 at an isometry (4), 1 at 25 times as
/// much, by logarithms.
double distortion_place(double energy);

/// The i-th of a sequence of colours of which neighbours in the sequence differ clearly.
Color category_color(int i);

/// The colour of a place in the unit cube: its coordinates as red, green and blue, a little
/// softened. Distant places differ in colour; nearby places never do.
Color position_color(const Vector3d& unit_position);

constexpr float kGreyLevel = 0.55F;
/// The colour of things without a colour of their own.
inline Color neutral_color() {
  return Color::Constant(kGreyLevel);
}

}  // namespace crosspatch
