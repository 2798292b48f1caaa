#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/soup.hpp"
#include "transfer/color_space.hpp"
#include "transfer/four_values.hpp"
#include "transfer/image_codec.hpp"

namespace crosspatch {

/// A texture prepared for filtered lookups: level k has half the sides of level k - 1 (rounded
/// down, at least 1) and holds its averages.
///
/// Values are linear, in 65535ths.
struct TexturePyramid {
  struct Level {
    int width = 0;
    int height = 0;
    int channels = 4;  ///< 3: alpha is 1
    /// channels * width * height, and one more: texels are read four values at once.
    std::vector<std::uint16_t> values;
  };
  std::vector<Level> levels;
};

/// What becomes of an image's alpha.
enum class Alpha {
  kIgnored,        ///< it is 1
  kPremultiplied,  ///< colour is multiplied by it, so that transparent texels do not bleed
};

TexturePyramid make_pyramid(const RasterImage& image, ColorSpace space, Alpha alpha);

/// The same from an image that is not needed any more: the first level takes its room. `in_use`, a
/// value a texel, or empty for all: texels that have false there are no part of any average. As far
/// as footprints of places in use reach they are filled smoothly from the others (Gortler et al.
/// 1996, "The lumigraph", Sec. 3.4), further away they hold anything.
TexturePyramid make_pyramid(RasterImage&& image,
                            ColorSpace space,
                            Alpha alpha,
                            std::vector<bool> in_use = {});

/// How a texel to be filled covers a texture: the same over a whole triangle.
struct Footprint {
  int level = 0;
  int taps_x = 1;
  int taps_y = 1;
  Eigen::Vector2f first{0, 0};                   ///< UV of the first tap, from the texel's centre
  Eigen::Vector2f along_x{0, 0}, along_y{0, 0};  ///< UV from tap to tap
};

/// The bilinear value, in 65535ths, at a place in texels from the centre of the level's first one;
/// no less than one texel from the last one's, in both directions.
inline FourFloats bilinear_inside(const TexturePyramid::Level& level, double x, double y) {
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const float s = static_cast<float>(x - i), t = static_cast<float>(y - j);
  const std::size_t channels = static_cast<std::size_t>(level.channels);
  const std::size_t row = channels * static_cast<std::size_t>(level.width);
  const std::uint16_t* p = level.values.data() + static_cast<std::size_t>(j) * row +
                           static_cast<std::size_t>(i) * channels;
  const FourFloats a = load_four(p), b = load_four(p + row);
  const FourFloats upper = a + (load_four(p + channels) - a) * s;
  const FourFloats lower = b + (load_four(p + row + channels) - b) * s;
  FourFloats value = upper + (lower - upper) * t;
  if (channels == 3) value[3] = 65535;
  return value;
}

/// `step`: UV per texel to be filled, columns x and y, finite. Taps lie on a grid in the texel to
/// be filled, at most 8 along either side, less than two texels of the level apart.
Footprint footprint(const TexturePyramid& texture, const Eigen::Matrix2d& step);

/// The mean over the footprint around `uv`, with the wrapping of `ref`. Values in [0, 1].
Eigen::Array4f sample(const TexturePyramid& texture,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv,
                      const Footprint& footprint);

/// The same in 65535ths, as it is painted.
FourFloats sample_four(const TexturePyramid& texture,
                       const TextureRef& ref,
                       const Eigen::Vector2f& uv,
                       const Footprint& footprint);

/// Places side by side: first + i step for i in [0, count), in UV.
struct SampleRow {
  Vector2d first, step;
  int count = 0;
};

/// Calls visit(value) for the samples of a row, one after the other: each is what sample_four says,
/// up to rounding. Quicker, as where no footprint leaves the image nothing is asked about its
/// borders.
template <class Visit>
void sample_row(const TexturePyramid& texture,
                const TextureRef& ref,
                const SampleRow& row,
                const Footprint& f,
                Visit visit) {
  const TexturePyramid::Level& level = texture.levels[static_cast<std::size_t>(f.level)];
  const Vector2d size(level.width, level.height);
  // In the level's texels, from the centre of its first one.
  const auto in_texels = [&](const Vector2d& uv) {
    return Vector2d(uv.cwiseProduct(size) - Vector2d::Constant(0.5));
  };
  const Vector2d first = in_texels(row.first);
  const Vector2d last = in_texels(row.first + (row.count - 1) * row.step);
  const Vector2d along_x = f.along_x.cast<double>().cwiseProduct(size);
  const Vector2d along_y = f.along_y.cast<double>().cwiseProduct(size);
  constexpr double kRounding = 1e-3;
  const Vector2d reach =
      0.5 * ((f.taps_x - 1) * along_x.cwiseAbs() + (f.taps_y - 1) * along_y.cwiseAbs()) +
      Vector2d::Constant(kRounding);
  const Vector2d low = first.cwiseMin(last) - reach, high = first.cwiseMax(last) + reach;
  if (!(low.minCoeff() >= 0 && (size - high).minCoeff() > 1)) {
    Vector2d uv = row.first;
    for (int i = 0; i < row.count; ++i, uv += row.step)
      visit(sample_four(texture, ref, uv.cast<float>(), f));
    return;
  }
  const Vector2d step = row.step.cwiseProduct(size);
  Vector2d corner = first + f.first.cast<double>().cwiseProduct(size);
  const float share = 1.0F / static_cast<float>(f.taps_x * f.taps_y);
  for (int i = 0; i < row.count; ++i, corner += step) {
    FourFloats sum{0, 0, 0, 0};
    Vector2d line = corner;
    for (int t = 0; t < f.taps_y; ++t, line += along_y) {
      Vector2d p = line;
      for (int s = 0; s < f.taps_x; ++s, p += along_x) sum += bilinear_inside(level, p[0], p[1]);
    }
    visit(sum * share);
  }
}

/// The bilinear value at `uv` of one level.
Eigen::Array4f sample(const TexturePyramid::Level& level,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv);

}  // namespace crosspatch
