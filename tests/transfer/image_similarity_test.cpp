#include "transfer/image_similarity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// A grey picture of value(x, y), in [0, 1].
template <class Value>
RasterImage grey(int size, Value value) {
  RasterImage image{size, size, 3, {}};
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      for (int k = 0; k < 3; ++k)
        image.values.push_back(static_cast<std::uint16_t>(std::lround(value(x, y) * 65535)));
  return image;
}

std::vector<std::uint8_t> all(int size) {
  return std::vector<std::uint8_t>(idx(size * size), 1);
}

TEST(ImageSimilarity, OfEqualPicturesIsPerfect) {
  const RasterImage waves = grey(32, [](int x, int y) { return 0.5 + 0.4 * std::sin(x * y); });
  const ImageSimilarity s = image_similarity(waves, waves, all(32));
  EXPECT_TRUE(std::isinf(s.psnr));
  EXPECT_NEAR(s.ssim, 1, 1e-3);  // windows are summed in single precision
}

TEST(ImageSimilarity, OfFlatPicturesFollowsTheFormulas) {
  // Wang et al. 2004, Eq. (13), without variance: (2 x y + C1) / (x^2 + y^2 + C1).
  const double x = 0.4, y = 0.5, c = 1e-4;
  const ImageSimilarity s = image_similarity(
      grey(24, [&](int, int) { return x; }), grey(24, [&](int, int) { return y; }), all(24));
  EXPECT_NEAR(s.psnr, 20, 1e-3);  // -20 log10(0.1)
  EXPECT_NEAR(s.ssim, (2 * x * y + c) / (x * x + y * y + c), 1e-3);
}

TEST(ImageSimilarity, OfANegativeIsNegative) {
  const auto board = [](int x, int y) { return (x / 2 + y / 2) % 2 == 0 ? 0.1 : 0.9; };
  const ImageSimilarity s = image_similarity(
      grey(32, board), grey(32, [&](int x, int y) { return 1 - board(x, y); }), all(32));
  EXPECT_LT(s.ssim, -0.9);
}

TEST(ImageSimilarity, LooksAtCoveredPixelsOnly) {
  const auto left = [](int x, int y) { return x < 16 ? 0.5 + 0.4 * std::sin(x + 2 * y) : 0.0; };
  const auto right = [&](int x, int y) { return x < 16 ? left(x, y) : 1.0; };
  std::vector<std::uint8_t> covered = all(32);
  for (std::size_t i = 0; i < covered.size(); ++i) covered[i] = i % 32 < 16 ? 1 : 0;
  const ImageSimilarity s = image_similarity(grey(32, left), grey(32, right), covered);
  EXPECT_TRUE(std::isinf(s.psnr));
  EXPECT_NEAR(s.ssim, 1, 1e-3);
  EXPECT_LT(image_similarity(grey(32, left), grey(32, right), all(32)).ssim, 0.7);
  const std::vector<std::uint8_t> nothing(covered.size(), 0);
  EXPECT_TRUE(std::isnan(image_similarity(grey(32, left), grey(32, right), nothing).ssim));
}

}  // namespace
}  // namespace crosspatch
