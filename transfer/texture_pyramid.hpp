#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/soup.hpp"
#include "transfer/color_space.hpp"
#include "transfer/image_codec.hpp"

namespace crosspatch {

/// A texture prepared for filtered lookups: level k has half the sides of level k - 1 (rounded
/// down, at least 1) and holds its averages.
///
/// Values are linear, in 65535ths, RGBA; colour is multiplied by alpha where that was asked for, so
/// that transparent texels do not bleed.
struct TexturePyramid {
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<std::uint16_t> rgba;
  };
  std::vector<Level> levels;
};

TexturePyramid make_pyramid(const RasterImage& image, ColorSpace space, bool premultiply);

/// How a texel to be filled covers a texture: the same over a whole triangle.
struct Footprint {
  int level = 0;
  int taps_x = 1;
  int taps_y = 1;
  Eigen::Matrix2f step = Eigen::Matrix2f::Zero();  ///< UV per texel to be filled, columns x and y
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

/// The bilinear value at `uv` of one level.
Eigen::Array4f sample(const TexturePyramid::Level& level,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv);

}  // namespace crosspatch
