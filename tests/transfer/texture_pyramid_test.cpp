#include "transfer/texture_pyramid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace crosspatch {
namespace {

RasterImage noise(int width, int height, int channels) {
  RasterImage image{width, height, channels, {}};
  std::mt19937 random(7);
  for (int i = 0; i < width * height * channels; ++i)
    image.values.push_back(static_cast<std::uint16_t>(random() % 65536));
  return image;
}

TEST(TexturePyramid, RowsAreWhatSinglePlacesAreInsideAndAcrossBorders) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.4, 1.4), step(-3.0, 3.0);
  for (const int channels : {3, 4}) {
    const TexturePyramid pyramid =
        make_pyramid(noise(48, 33, channels), ColorSpace::kLinear, Alpha::kPremultiplied);
    for (const int wrap : {10497, 33071, 33648}) {
      TextureRef ref;
      ref.wrap_s = ref.wrap_t = wrap;
      for (int i = 0; i < 300; ++i) {
        // Half of the rows are short and near the middle, where no border is near.
        const double size = i % 2 == 0 ? 0.2 : 1;
        const SampleRow row{
            Vector2d(0.5 + size * (place(random) - 0.5), 0.5 + size * (place(random) - 0.5)),
            Vector2d(step(random) / 48, step(random) / 33) * size,
            1 + i % 9};
        Eigen::Matrix2d texel;
        texel << step(random), step(random), step(random), step(random);
        const Footprint f = footprint(pyramid, texel / 40);
        int visited = 0;
        sample_row(pyramid, ref, row, f, [&](const FourFloats& value) {
          const Vector2d uv = row.first + visited * row.step;
          const FourFloats alone = sample_four(pyramid, ref, uv.cast<float>(), f);
          // Places in single precision: a millionth of 48 texels, times the whole range.
          for (int k = 0; k < 4; ++k) EXPECT_NEAR(value[k], alone[k], 65535 * 1e-4) << i;
          ++visited;
        });
        EXPECT_EQ(visited, row.count);
      }
    }
  }
}

TEST(TexturePyramid, TexelsOutOfUseRunIntoNoLevel) {
  // A disc of 9000 on 60000, of a size whose halves are odd; with room for the pyramid or without.
  const int width = 90, height = 54;
  std::vector<bool> in_use;
  RasterImage image{width, height, 3, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      in_use.push_back(std::hypot(x - 40, y - 25) < 18);
      image.values.insert(image.values.end(), 3, in_use.back() ? 9000 : 60000);
    }
  for (const bool room : {false, true}) {
    RasterImage given = image;
    if (room) given.values.reserve(given.values.size() + 1);
    const TexturePyramid pyramid =
        make_pyramid(std::move(given), ColorSpace::kLinear, Alpha::kIgnored, in_use);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    int levels = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vector2d texel(40.5 + 17 * unit(random), 25.5 + 17 * unit(random));
      if ((texel - Vector2d(40.5, 25.5)).norm() > 17) continue;
      const double size = std::exp2(3 * unit(random) + 1);
      Eigen::Matrix2d step;
      step << unit(random), unit(random), unit(random), unit(random);
      const Footprint f = footprint(pyramid, step * size / width);
      levels = std::max(levels, f.level);
      const Eigen::Vector2f uv(static_cast<float>(texel[0]) / width,
                               static_cast<float>(texel[1]) / height);
      // Weights of single precision, of up to 64 taps.
      EXPECT_NEAR(sample_four(pyramid, {}, uv, f)[0], 9000, 0.1) << i << ", level " << f.level;
    }
    EXPECT_GE(levels, 2);
  }
}

}  // namespace
}  // namespace crosspatch
