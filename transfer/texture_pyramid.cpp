#include "transfer/texture_pyramid.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace crosspatch {
namespace {

constexpr int kClamp = 33071;
constexpr int kMirror = 33648;
constexpr float kScale = 1.0F / 65535;

Eigen::Array4f load(const std::uint16_t* p) {
  return {static_cast<float>(p[0]),
          static_cast<float>(p[1]),
          static_cast<float>(p[2]),
          static_cast<float>(p[3])};
}

void store(const Eigen::Array4f& value, std::uint16_t* p) {
  for (int k = 0; k < 4; ++k) p[k] = static_cast<std::uint16_t>(value[k] + 0.5F);
}

/// Averages `from` to half its sides; where those are odd, texels count by the share they have.
TexturePyramid::Level halved(const TexturePyramid::Level& from) {
  TexturePyramid::Level to{std::max(1, from.width / 2), std::max(1, from.height / 2), {}};
  to.rgba.resize(4 * idx(to.width) * idx(to.height));
  if (from.width == 2 * to.width && from.height == 2 * to.height) {
    for (int y = 0; y < to.height; ++y)
      for (int x = 0; x < 4 * to.width; ++x) {
        const std::size_t row = 4 * idx(from.width);
        const std::size_t first = 2 * idx(y) * row + 8 * idx(x / 4) + idx(x % 4);
        const std::uint32_t sum = std::uint32_t{from.rgba[first]} + from.rgba[first + 4] +
                                  from.rgba[first + row] + from.rgba[first + row + 4];
        to.rgba[4 * idx(y) * idx(to.width) + idx(x)] = static_cast<std::uint16_t>((sum + 2) / 4);
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
      Eigen::Array4f sum = Eigen::Array4f::Zero();
      for (int j = static_cast<int>(top); j < bottom; ++j) {
        const double high = std::min<double>(bottom, j + 1) - std::max<double>(top, j);
        for (int i = static_cast<int>(left); i < right; ++i) {
          const double wide = std::min<double>(right, i + 1) - std::max<double>(left, i);
          sum += static_cast<float>(high * wide) *
                 load(&from.rgba[4 * (idx(j) * idx(from.width) + idx(i))]);
        }
      }
      store(sum / static_cast<float>((bottom - top) * (right - left)),
            &to.rgba[4 * (idx(y) * idx(to.width) + idx(x))]);
    }
  }
  return to;
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

TexturePyramid make_pyramid(const RasterImage& image, ColorSpace space, bool premultiply) {
  TexturePyramid pyramid;
  TexturePyramid::Level first{image.width, image.height, {}};
  const std::size_t texels = idx(image.width) * idx(image.height);
  const std::size_t channels = idx(image.channels);
  first.rgba.resize(4 * texels);
  std::vector<std::uint16_t> linear(65536);
  for (std::size_t v = 0; v < linear.size(); ++v)
    linear[v] = static_cast<std::uint16_t>(
        std::lround(to_linear_light(static_cast<std::uint16_t>(v), space) / kScale));
  for (std::size_t i = 0; i < texels; ++i) {
    const std::uint16_t* in = &image.values[i * channels];
    std::uint16_t* out = &first.rgba[4 * i];
    const std::uint32_t alpha = channels % 2 == 0 ? in[channels - 1] : 65535;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t value = linear[in[channels < 3 ? 0 : k]];
      out[k] = static_cast<std::uint16_t>(premultiply ? (value * alpha + 32767) / 65535 : value);
    }
    out[3] = static_cast<std::uint16_t>(alpha);
  }
  pyramid.levels.push_back(std::move(first));
  while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1)
    pyramid.levels.push_back(halved(pyramid.levels.back()));
  return pyramid;
}

Footprint footprint(const TexturePyramid& texture, const Eigen::Matrix2d& step) {
  constexpr int kMostTaps = 8;
  const auto& base = texture.levels.front();
  const Eigen::Matrix2d texels = Vector2d(base.width, base.height).asDiagonal() * step;
  const double along_x = texels.col(0).norm(), along_y = texels.col(1).norm();
  const double shortest = texels.jacobiSvd().singularValues()[1];
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
  f.step = step.cast<float>();
  return f;
}

Eigen::Array4f sample(const TexturePyramid::Level& level,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv) {
  // Beyond that a float no longer tells texels apart.
  constexpr float kFarthest = 1e6F;
  const auto texels = [](float u, int size) {
    return std::clamp(u, -kFarthest / 16384, kFarthest / 16384) * static_cast<float>(size) - 0.5F;
  };
  const float x = texels(uv[0], level.width), y = texels(uv[1], level.height);
  const float left = std::floor(x), top = std::floor(y);
  const int i = static_cast<int>(left), j = static_cast<int>(top);
  const std::size_t x0 = idx(wrapped(i, level.width, ref.wrap_s));
  const std::size_t x1 = idx(wrapped(i + 1, level.width, ref.wrap_s));
  const std::size_t row0 = idx(wrapped(j, level.height, ref.wrap_t)) * idx(level.width);
  const std::size_t row1 = idx(wrapped(j + 1, level.height, ref.wrap_t)) * idx(level.width);
  const float s = x - left, t = y - top;
  const auto at = [&](std::size_t texel) { return load(&level.rgba[4 * texel]); };
  const Eigen::Array4f upper = at(row0 + x0) * (1 - s) + at(row0 + x1) * s;
  const Eigen::Array4f lower = at(row1 + x0) * (1 - s) + at(row1 + x1) * s;
  return (upper * (1 - t) + lower * t) * kScale;
}

Eigen::Array4f sample(const TexturePyramid& texture,
                      const TextureRef& ref,
                      const Eigen::Vector2f& uv,
                      const Footprint& f) {
  const TexturePyramid::Level& level = texture.levels[idx(f.level)];
  if (f.taps_x == 1 && f.taps_y == 1) return sample(level, ref, uv);
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  const float nx = static_cast<float>(f.taps_x), ny = static_cast<float>(f.taps_y);
  for (int j = 0; j < f.taps_y; ++j)
    for (int i = 0; i < f.taps_x; ++i) {
      const Eigen::Vector2f offset((static_cast<float>(i) + 0.5F) / nx - 0.5F,
                                   (static_cast<float>(j) + 0.5F) / ny - 0.5F);
      sum += sample(level, ref, uv + f.step * offset);
    }
  return sum / (nx * ny);
}

}  // namespace crosspatch
