#include "transfer/texture_pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/index.hpp"

namespace crosspatch {
namespace {

constexpr int kClamp = 33071;
constexpr int kMirror = 33648;
constexpr float kScale = 1.0F / 65535;

TexturePyramid::Level make_level(int width, int height, int channels) {
  TexturePyramid::Level level{width, height, channels, {}};
  level.values.resize(idx(channels) * idx(width) * idx(height) + 1);
  return level;
}

/// Averages `from` to half its sides; where those are odd, texels count by the share they have.
TexturePyramid::Level halved(const TexturePyramid::Level& from) {
  const std::size_t channels = idx(from.channels);
  TexturePyramid::Level to =
      make_level(std::max(1, from.width / 2), std::max(1, from.height / 2), from.channels);
  const std::size_t row = channels * idx(from.width);
  if (from.width == 2 * to.width && from.height == 2 * to.height) {
    std::uint16_t* out = to.values.data();
    for (int y = 0; y < to.height; ++y) {
      const std::uint16_t* in = &from.values[2 * idx(y) * row];
      for (int x = 0; x < to.width; ++x, in += channels)
        for (std::size_t k = 0; k < channels; ++k, ++in, ++out) {
          const std::uint32_t sum =
              std::uint32_t{in[0]} + in[channels] + in[row] + in[row + channels];
          *out = static_cast<std::uint16_t>((sum + 2) / 4);
        }
    }
    return to;
  }
  const auto span = [](int i, int size, int of) {
    return std::pair(static_cast<double>(i) * of / size, static_cast<double>(i + 1) * of / size);
  };
  for (int y = 0; y < to.height; ++y) {
    const auto [top, bottom] = span(y, to.height, from.height);
    for (int x = 0; x < to.width; ++x) {
      const auto [left, right] = span(x, to.width, from.width);
      FourFloats sum{0, 0, 0, 0};
      for (int j = static_cast<int>(top); j < bottom; ++j) {
        const double high = std::min<double>(bottom, j + 1) - std::max<double>(top, j);
        for (int i = static_cast<int>(left); i < right; ++i) {
          const double wide = std::min<double>(right, i + 1) - std::max<double>(left, i);
          sum += static_cast<float>(high * wide) *
                 load_four(&from.values[idx(j) * row + channels * idx(i)]);
        }
      }
      sum /= static_cast<float>((bottom - top) * (right - left));
      for (std::size_t k = 0; k < channels; ++k)
        to.values[channels * (idx(y) * idx(to.width) + idx(x)) + k] =
            static_cast<std::uint16_t>(sum[k] + 0.5F);
    }
  }
  return to;
}

int level_channels(const RasterImage& image, Alpha alpha) {
  return alpha == Alpha::kPremultiplied && image.channels % 2 == 0 ? 4 : 3;
}

/// Linear values of all texels. `out` may be the image's own, if its texels do not get wider: none
/// is written over before it has been read.
void to_linear(const RasterImage& image, ColorSpace space, int channels, std::uint16_t* out) {
  std::vector<std::uint16_t> linear(65536);
  for (std::size_t v = 0; v < linear.size(); ++v)
    linear[v] = static_cast<std::uint16_t>(
        std::lround(to_linear_light(static_cast<std::uint16_t>(v), space) / kScale));
  const std::size_t texels = idx(image.width) * idx(image.height), stride = idx(image.channels);
  for (std::size_t i = 0; i < texels; ++i) {
    const std::uint16_t* in = &image.values[i * stride];
    const std::uint16_t alpha = in[stride - 1];
    std::array<std::uint32_t, 3> color{};
    for (std::size_t k = 0; k < 3; ++k) color[k] = linear[in[stride < 3 ? 0 : k]];
    for (const std::uint32_t c : color)
      *out++ = static_cast<std::uint16_t>(channels == 4 ? (c * alpha + 32767) / 65535 : c);
    if (channels == 4) *out++ = alpha;
  }
}

TexturePyramid with_coarser_levels(TexturePyramid::Level first) {
  TexturePyramid pyramid;
  pyramid.levels.push_back(std::move(first));
  while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1)
    pyramid.levels.push_back(halved(pyramid.levels.back()));
  return pyramid;
}

int wrapped(int i, int size, int mode) {
  if (i >= 0 && i < size) return i;
  if (mode == kClamp) return std::clamp(i, 0, size - 1);
  const int period = mode == kMirror ? 2 * size : size;
  i %= period;
  if (i < 0) i += period;
  return i < size ? i : 2 * size - 1 - i;
}

}  // namespace

TexturePyramid make_pyramid(const RasterImage& image, ColorSpace space, Alpha alpha) {
  const int channels = level_channels(image, alpha);
  TexturePyramid::Level first = make_level(image.width, image.height, channels);
  to_linear(image, space, channels, first.values.data());
  return with_coarser_levels(std::move(first));
}

TexturePyramid make_pyramid(RasterImage&& image, ColorSpace space, Alpha alpha) {
  const int channels = level_channels(image, alpha);
  const std::size_t wanted = idx(channels) * idx(image.width) * idx(image.height) + 1;
  if (image.channels < channels || image.values.capacity() < wanted)
    return make_pyramid(std::as_const(image), space, alpha);
  to_linear(image, space, channels, image.values.data());
  image.values.resize(wanted);
  image.values.shrink_to_fit();
  return with_coarser_levels({image.width, image.height, channels, std::move(image.values)});
}

Footprint footprint(const TexturePyramid& texture, const Eigen::Matrix2d& step) {
  constexpr int kMostTaps = 8;
  const auto& base = texture.levels.front();
  const Eigen::Matrix2d texels = Vector2d(base.width, base.height).asDiagonal() * step;
  const double along_x = texels.col(0).norm(), along_y = texels.col(1).norm();
  // The smaller singular value is the determinant over the larger one; squares of both add up to
  // the squares of the columns.
  const double sum = texels.squaredNorm(), product = std::abs(texels.determinant());
  const double longest =
      std::sqrt((sum + std::sqrt(std::max(0.0, sum * sum - 4 * product * product))) / 2);
  const double shortest = longest > 0 ? product / longest : 0;
  const double needed = std::max({shortest, along_x / kMostTaps, along_y / kMostTaps, 1.0});
  Footprint f;
  f.level =
      static_cast<int>(std::min(std::log2(needed), static_cast<double>(texture.levels.size() - 1)));
  const double level_texel = std::ldexp(1.0, f.level);
  const auto taps = [&](double length) {
    return static_cast<int>(std::clamp(std::ceil(length / level_texel), 1.0, double{kMostTaps}));
  };
  f.taps_x = taps(along_x);
  f.taps_y = taps(along_y);
  f.along_x = (step.col(0) / f.taps_x).cast<float>();
  f.along_y = (step.col(1) / f.taps_y).cast<float>();
  f.first = -0.5F * (static_cast<float>(f.taps_x - 1) * f.along_x +
                     static_cast<float>(f.taps_y - 1) * f.along_y);
  return f;
}

namespace {

/// Largest whole number that is not above x; |x| < 2^31.
int floored(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

/// The bilinear value, in 65535ths.
FourFloats bilinear(const TexturePyramid::Level& level, const TextureRef& ref, float u, float v) {
  // Beyond that a float no longer tells texels apart.
  constexpr float kFarthest = 1e6F / 16384;
  const float x = std::clamp(u, -kFarthest, kFarthest) * static_cast<float>(level.width) - 0.5F;
  const float y = std::clamp(v, -kFarthest, kFarthest) * static_cast<float>(level.height) - 0.5F;
  const int i = floored(x), j = floored(y);
  const std::size_t x0 = idx(wrapped(i, level.width, ref.wrap_s));
  const std::size_t x1 = idx(wrapped(i + 1, level.width, ref.wrap_s));
  const std::size_t row0 = idx(wrapped(j, level.height, ref.wrap_t)) * idx(level.width);
  const std::size_t row1 = idx(wrapped(j + 1, level.height, ref.wrap_t)) * idx(level.width);
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  const auto at = [&](std::size_t texel) {
    return load_four(&level.values[idx(level.channels) * texel]);
  };
  const FourFloats upper = at(row0 + x0) * (1 - s) + at(row0 + x1) * s;
  const FourFloats lower = at(row1 + x0) * (1 - s) + at(row1 + x1) * s;
  FourFloats value = upper * (1 - t) + lower * t;
  if (level.channels == 3) value[3] = 65535;
  return value;
}

}  // namespace

Eigen::Array4f sample(const TexturePyramid::Level& level,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv) {
  return to_array(bilinear(level, ref, uv[0], uv[1]) * kScale);
}

FourFloats sample_four(const TexturePyramid& texture,
                       const TextureRef& ref,
                       const Eigen::Vector2f& uv,
                       const Footprint& f) {
  const TexturePyramid::Level& level = texture.levels[idx(f.level)];
  if (f.taps_x == 1 && f.taps_y == 1) return bilinear(level, ref, uv[0], uv[1]);
  FourFloats sum{0, 0, 0, 0};
  for (int j = 0; j < f.taps_y; ++j) {
    const Eigen::Vector2f row = uv + f.first + static_cast<float>(j) * f.along_y;
    for (int i = 0; i < f.taps_x; ++i)
      sum += bilinear(level,
                      ref,
                      row[0] + static_cast<float>(i) * f.along_x[0],
                      row[1] + static_cast<float>(i) * f.along_x[1]);
  }
  return sum / static_cast<float>(f.taps_x * f.taps_y);
}

Eigen::Array4f sample(const TexturePyramid& texture,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv,
                      const Footprint& f) {
  return to_array(sample_four(texture, ref, uv, f) * kScale);
}

}  // namespace crosspatch
