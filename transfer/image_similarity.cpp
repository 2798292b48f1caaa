#include "transfer/image_similarity.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/index.hpp"

namespace crosspatch {
namespace {

constexpr int kReach = 5;  // pixels on either side of a window's middle

/// Luma of ITU-R BT.709, in [0, 1].
std::vector<float> luma(const RasterImage& image) {
  std::vector<float> result(idx(image.width) * idx(image.height));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::uint16_t* p = &image.values[i * idx(image.channels)];
    result[i] = (0.2126F * static_cast<float>(p[0]) + 0.7152F * static_cast<float>(p[1]) +
                 0.0722F * static_cast<float>(p[2])) /
                65535;
  }
  return result;
}

/// Weighted sums over windows of a plane that is taken as 0 outside of the picture.
std::vector<float> blurred(const std::vector<float>& plane, int width, int height) {
  std::array<float, 2 * kReach + 1> weight{};
  constexpr float kDeviation = 1.5F;
  float sum = 0;
  for (int i = -kReach; i <= kReach; ++i) {
    const float x = static_cast<float>(i) / kDeviation;
    sum += weight[idx(i + kReach)] = std::exp(-x * x / 2);
  }
  for (float& w : weight) w /= sum;
  // One step along a line; `stride` is from pixel to pixel of it.
  const auto filter = [&](const float* in, float* out, int length, std::size_t stride) {
    for (int i = 0; i < length; ++i) {
      float value = 0;
      for (int j = std::max(0, i - kReach); j <= std::min(length - 1, i + kReach); ++j)
        value += weight[idx(j - i + kReach)] * in[idx(j) * stride];
      out[idx(i) * stride] = value;
    }
  };
  std::vector<float> rows(plane.size()), result(plane.size());
  for (int y = 0; y < height; ++y)
    filter(&plane[idx(y) * idx(width)], &rows[idx(y) * idx(width)], width, 1);
  for (int x = 0; x < width; ++x) filter(&rows[idx(x)], &result[idx(x)], height, idx(width));
  return result;
}

double mean_ssim(const RasterImage& a,
                 const RasterImage& b,
                 const std::vector<std::uint8_t>& covered) {
  const std::vector<float> x = luma(a), y = luma(b);
  // The means over a window of a product with the mask.
  const auto sums = [&](auto value) {
    std::vector<float> plane(x.size(), 0.0F);
    for (std::size_t i = 0; i < plane.size(); ++i)
      if (covered[i] != 0) plane[i] = value(x[i], y[i]);
    return blurred(plane, a.width, a.height);
  };
  const std::vector<float> weight = sums([](float, float) { return 1.0F; });
  const std::vector<float> mean_x = sums([](float u, float) { return u; });
  const std::vector<float> mean_y = sums([](float, float v) { return v; });
  const std::vector<float> squares = sums([](float u, float v) { return u * u + v * v; });
  const std::vector<float> products = sums([](float u, float v) { return u * v; });
  constexpr double kLuminance = 0.01 * 0.01, kContrast = 0.03 * 0.03;  // C1 and C2; range is 1
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (covered[i] == 0) continue;
    const double w = weight[i], mx = mean_x[i] / w, my = mean_y[i] / w;
    const double variances = squares[i] / w - mx * mx - my * my;
    const double covariance = products[i] / w - mx * my;
    sum += (2 * mx * my + kLuminance) * (2 * covariance + kContrast) /
           ((mx * mx + my * my + kLuminance) * (variances + kContrast));
    ++count;
  }
  return sum / count;
}

}  // namespace

ImageSimilarity image_similarity(const RasterImage& a,
                                 const RasterImage& b,
                                 const std::vector<std::uint8_t>& covered) {
  assert(a.width == b.width && a.height == b.height && a.channels >= 3 && b.channels >= 3);
  assert(covered.size() == idx(a.width) * idx(a.height));
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    if (covered[i] == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d =
          (double{0} + a.values[i * idx(a.channels) + k] - b.values[i * idx(b.channels) + k]) /
          65535;
      squares += d * d;
    }
    count += 3;
  }
  if (count == 0) {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    return {kNothing, kNothing};
  }
  return {-10 * std::log10(squares / count), mean_ssim(a, b, covered)};
}

}  // namespace crosspatch
