#include "transfer/texture_pyramid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/index.hpp"

namespace crosspatch {
namespace {

constexpr int kRepeat = 10497;
constexpr int kClamp = 33071;
constexpr int kMirror = 33648;
constexpr float kScale = 1.0F / 65535;

TexturePyramid::Level make_level(int width, int height, int channels) {
  TexturePyramid::Level level{width, height, channels, {}};
  level.values.resize(idx(channels) * idx(width) * idx(height) + 1);
  return level;
}

/// A value a texel of a level: false where it holds nothing. Empty: all hold something.
using Mask = std::vector<bool>;

/// How many of the 2 x 2 texels from `texel` on hold something.
int count_in_block(const Mask& mask, std::size_t texel, std::size_t width) {
  if (mask.empty()) return 4;
  return int{mask[texel]} + int{mask[texel + 1]} + int{mask[texel + width]} +
         int{mask[texel + width + 1]};
}

/// The mean of the texels of `from` inside [left, right) x [top, bottom] that hold something, each
/// by the share that lies inside; nothing where none does.
std::optional<FourFloats> mean(const TexturePyramid::Level& from,
                               const Mask& mask,
                               const Eigen::AlignedBox2d& box) {
  FourFloats sum{0, 0, 0, 0};
  double weight = 0;
  for (int j = static_cast<int>(box.min()[1]); j < box.max()[1]; ++j) {
    const double high = std::min<double>(box.max()[1], j + 1) - std::max<double>(box.min()[1], j);
    for (int i = static_cast<int>(box.min()[0]); i < box.max()[0]; ++i) {
      const std::size_t texel = idx(j) * idx(from.width) + idx(i);
      if (!mask.empty() && !mask[texel]) continue;
      const double wide = std::min<double>(box.max()[0], i + 1) - std::max<double>(box.min()[0], i);
      sum += static_cast<float>(high * wide) * load_four(&from.values[idx(from.channels) * texel]);
      weight += high * wide;
    }
  }
  if (weight == 0) return std::nullopt;
  return sum / static_cast<float>(weight);
}

/// Averages `from` to half its sides; where those are odd, texels count by the share they have, and
/// those that hold nothing do not count. `mask` becomes that of the result.
TexturePyramid::Level halved(const TexturePyramid::Level& from, Mask& mask) {
  const std::size_t channels = idx(from.channels), row = channels * idx(from.width);
  TexturePyramid::Level to =
      make_level(std::max(1, from.width / 2), std::max(1, from.height / 2), from.channels);
  const bool even = from.width == 2 * to.width && from.height == 2 * to.height;
  const auto corner = [&](int x, int y) {  // exact at the far border
    return Vector2d(static_cast<double>(x) * from.width / to.width,
                    static_cast<double>(y) * from.height / to.height);
  };
  Mask coarse(mask.empty() ? 0 : idx(to.width) * idx(to.height), true);
  std::size_t texel = 0;
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x, ++texel) {
      std::uint16_t* out = &to.values[channels * texel];
      const std::size_t first = 2 * (idx(y) * idx(from.width) + idx(x));
      const int count = even ? count_in_block(mask, first, idx(from.width)) : -1;
      if (count == 4) {
        const std::uint16_t* in = &from.values[channels * first];
        for (std::size_t k = 0; k < channels; ++k, ++in) {
          const std::uint32_t sum =
              std::uint32_t{in[0]} + in[channels] + in[row] + in[row + channels];
          out[k] = static_cast<std::uint16_t>((sum + 2) / 4);
        }
        continue;
      }
      const std::optional<FourFloats> value =
          count == 0 ? std::nullopt : mean(from, mask, {corner(x, y), corner(x + 1, y + 1)});
      if (value)
        store_values(*value, from.channels, out);
      else
        coarse[texel] = false;
    }
  // Where all texels hold something there is nothing to be asked about any more.
  mask =
      std::find(coarse.begin(), coarse.end(), false) == coarse.end() ? Mask{} : std::move(coarse);
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

int wrapped(int i, int size, int mode) {
  if (i >= 0 && i < size) return i;
  if (mode == kClamp) return std::clamp(i, 0, size - 1);
  const int period = mode == kMirror ? 2 * size : size;
  i %= period;
  if (i < 0) i += period;
  return i < size ? i : 2 * size - 1 - i;
}

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

TexturePyramid::Level first_level(const RasterImage& image, ColorSpace space, Alpha alpha) {
  const int channels = level_channels(image, alpha);
  TexturePyramid::Level first = make_level(image.width, image.height, channels);
  to_linear(image, space, channels, first.values.data());
  return first;
}

/// Levels from one to that whose texels are as large as a footprint reaches: eight taps each way,
/// up to two texels apart.
constexpr std::size_t kReachLevels = 4;

/// Fills the texels of `fine` that hold nothing with what `coarse` has there; only near texels of
/// `far` that hold something, further away no footprint gets.
void fill(TexturePyramid::Level& fine,
          const Mask& mask,
          const TexturePyramid::Level& coarse,
          const TexturePyramid::Level& far,
          const Mask& far_mask) {
  TextureRef clamped;
  clamped.wrap_s = clamped.wrap_t = kClamp;
  const auto is_near = [&](int x, int y) {
    if (far_mask.empty()) return true;
    for (int j = y - 1; j <= y + 1; ++j)  // around the image's borders too, as taps may go
      for (int i = x - 1; i <= x + 1; ++i)
        if (far_mask[idx(wrapped(j, far.height, kRepeat)) * idx(far.width) +
                     idx(wrapped(i, far.width, kRepeat))])
          return true;
    return false;
  };
  const auto part = [](int i, int parts, int of) {  // where part i of so many begins
    return static_cast<int>((std::int64_t{i} * of + parts - 1) / parts);
  };
  for (int v = 0; v < far.height; ++v)
    for (int u = 0; u < far.width; ++u) {
      if (!is_near(u, v)) continue;
      for (int y = part(v, far.height, fine.height); y < part(v + 1, far.height, fine.height); ++y)
        for (int x = part(u, far.width, fine.width); x < part(u + 1, far.width, fine.width); ++x) {
          const std::size_t texel = idx(y) * idx(fine.width) + idx(x);
          if (mask[texel]) continue;
          const FourFloats value =
              bilinear(coarse,
                       clamped,
                       (static_cast<float>(x) + 0.5F) / static_cast<float>(fine.width),
                       (static_cast<float>(y) + 0.5F) / static_cast<float>(fine.height));
          store_values(value, fine.channels, &fine.values[idx(fine.channels) * texel]);
        }
    }
}

TexturePyramid with_coarser_levels(TexturePyramid::Level first, Mask mask) {
  TexturePyramid pyramid;
  pyramid.levels.push_back(std::move(first));
  if (std::find(mask.begin(), mask.end(), false) == mask.end()) mask.clear();
  std::vector<Mask> masks{std::move(mask)};
  while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1) {
    Mask next = masks.back();
    pyramid.levels.push_back(halved(pyramid.levels.back(), next));
    masks.push_back(std::move(next));
  }
  for (std::size_t i = pyramid.levels.size() - 1; i-- > 0;) {
    const std::size_t far = std::min(i + kReachLevels, pyramid.levels.size() - 1);
    if (!masks[i].empty())
      fill(pyramid.levels[i], masks[i], pyramid.levels[i + 1], pyramid.levels[far], masks[far]);
  }
  return pyramid;
}

}  // namespace

TexturePyramid make_pyramid(const RasterImage& image, ColorSpace space, Alpha alpha) {
  return with_coarser_levels(first_level(image, space, alpha), {});
}

TexturePyramid make_pyramid(RasterImage&& image,
                            ColorSpace space,
                            Alpha alpha,
                            std::vector<bool> in_use) {
  const int channels = level_channels(image, alpha);
  const std::size_t wanted = idx(channels) * idx(image.width) * idx(image.height) + 1;
  if (image.channels < channels || image.values.capacity() < wanted)
    return with_coarser_levels(first_level(image, space, alpha), std::move(in_use));
  to_linear(image, space, channels, image.values.data());
  image.values.resize(wanted);
  image.values.shrink_to_fit();
  return with_coarser_levels({image.width, image.height, channels, std::move(image.values)},
                             std::move(in_use));
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
