#include "transfer/texture_pyramid.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace crosspatch
