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

/// The same from an image that is not needed any more: the first level takes its room.
TexturePyramid make_pyramid(RasterImage&& image, ColorSpace space, Alpha alpha);

/// How a texel to be filled covers a texture: the same over a whole triangle.
struct Footprint {
  int level = 0;
  int taps_x = 1;
  int taps_y = 1;
  Eigen::Vector2f first{0, 0};                   ///< UV of the first tap, from the texel's centre
  Eigen::Vector2f along_x{0, 0}, along_y{0, 0};  ///< UV from tap to tap
};

/// `step`: UV per texel to be filled, columns x and y, finite. Taps lie on a grid in the texel to
/// be filled, no further apart than the texels of the level, which is the finest that needs at most
/// 8 taps along either side.
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

/// The bilinear value at `uv` of one level.
Eigen::Array4f sample(const TexturePyramid::Level& level,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv);

}  // namespace crosspatch
