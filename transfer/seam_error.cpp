#include "transfer/seam_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/index.hpp"
#include "transfer/texel_raster.hpp"
#include "transfer/texture_pyramid.hpp"

namespace crosspatch {
namespace {

constexpr int kClamp = 33071;

Eigen::Array3f stored(const Eigen::Array4f& linear) {
  Eigen::Array3f value;
  for (int k = 0; k < 3; ++k)
    value[k] = static_cast<float>(to_stored(
                   static_cast<std::uint16_t>(std::lround(linear[k] * 65535)), ColorSpace::kSrgb)) /
               257;
  return value;
}

/// A number of its own, from 1, for each chart of the unwrap; charts beyond the 65535th share
/// theirs with others.
std::vector<std::uint16_t> chart_of_face(const TriangleMesh& mesh, const Unwrap& unwrap) {
  std::vector<std::uint16_t> number;
  for (const int chart : charts_of(mesh, unwrap))
    number.push_back(static_cast<std::uint16_t>(1 + chart % 65535));
  return number;
}

/// The chart that holds each texel's centre, or 0.
std::vector<std::uint16_t> chart_of_texel(const Unwrap& unwrap,
                                          const std::vector<std::uint16_t>& chart_of_face,
                                          int size) {
  std::vector<std::uint16_t> chart(idx(size) * idx(size), 0);
  for (int f = 0; f < static_cast<int>(chart_of_face.size()); ++f)
    for_each_span(in_texels(unwrap, f, size), 0, {0, size}, size, [&](const TexelSpan& span) {
      std::fill_n(chart.begin() + static_cast<std::ptrdiff_t>(size) * span.y + span.left,
                  span.right - span.left + 1,
                  chart_of_face[idx(f)]);
    });
  return chart;
}

/// Least and largest stored values, of 255.
struct Contrast {
  Eigen::Array3f low = Eigen::Array3f::Constant(255), high = Eigen::Array3f::Zero();

  [[nodiscard]] Eigen::Array3f width() const { return (high - low).max(0); }
};

/// What the insides of charts hold: it comes from the source alone, unlike their gutters.
class Insides {
 public:
  Insides(const TexturePyramid::Level& texels, std::vector<std::uint16_t> chart_of_texel)
      : texels_(texels), chart_(std::move(chart_of_texel)) {}

  /// Adds the means of the 4 x 4 texels of mip `level` around `uv`, as far as they lie inside of
  /// the chart: those that a bilinear look-up reads, and one more to each side.
  void add(std::uint16_t chart, const Vector2d& uv, int level, Contrast& contrast) const {
    const int side = 1 << level;
    const auto first = [&](double x) {
      return static_cast<int>(std::floor(x * texels_.width / side - 0.5)) - 1;
    };
    for (int y = first(uv[1]), i = 0; i < 4; ++i)
      for (int x = first(uv[0]), j = 0; j < 4; ++j)
        add_mean(chart, (x + j) * side, (y + i) * side, side, contrast);
  }

 private:
  void add_mean(std::uint16_t chart, int left, int top, int side, Contrast& contrast) const {
    Eigen::Array4f sum = Eigen::Array4f::Zero();
    int count = 0;
    for (int y = std::max(0, top); y < std::min(texels_.height, top + side); ++y)
      for (int x = std::max(0, left); x < std::min(texels_.width, left + side); ++x) {
        const std::size_t texel = idx(y) * idx(texels_.width) + idx(x);
        if (chart_[texel] != chart) continue;
        const std::uint16_t* value = &texels_.values[idx(texels_.channels) * texel];
        for (int k = 0; k < 3; ++k) sum[k] += value[k];
        ++count;
      }
    if (count == 0) return;
    const Eigen::Array3f mean = stored(sum / (65535.0F * static_cast<float>(count)));
    contrast.low = contrast.low.min(mean);
    contrast.high = contrast.high.max(mean);
  }

  const TexturePyramid::Level& texels_;
  std::vector<std::uint16_t> chart_;
};

/// Lengths over the differences found there, in steps of a sixteenth.
class Histogram {
 public:
  void add(float difference, double length) {
    lengths_[std::min(lengths_.size() - 1, static_cast<std::size_t>(difference * kSteps))] +=
        length;
    total_ += length;
  }
  /// What is not exceeded on this share of the length; 0 if there is none.
  [[nodiscard]] double quantile(double share) const {
    double sum = 0, difference = 0;
    for (std::size_t bin = 0; bin < lengths_.size() && sum < share * total_; ++bin) {
      sum += lengths_[bin];
      difference = static_cast<double>(bin + 1) / kSteps;
    }
    return difference;
  }

 private:
  static constexpr int kSteps = 16;
  std::vector<double> lengths_ = std::vector<double>(std::size_t{256} * kSteps, 0.0);
  double total_ = 0;
};

}  // namespace

std::array<double, kSeamLevels> seam_error(const RasterImage& image,
                                           const TriangleMesh& mesh,
                                           const Unwrap& unwrap) {
  const TexturePyramid pyramid = make_pyramid(image, ColorSpace::kSrgb, Alpha::kIgnored);
  const std::vector<std::uint16_t> chart = chart_of_face(mesh, unwrap);
  const Insides insides(pyramid.levels[0], chart_of_texel(unwrap, chart, image.width));
  TextureRef clamped;
  clamped.wrap_s = clamped.wrap_t = kClamp;
  const int levels = std::min(kSeamLevels, static_cast<int>(pyramid.levels.size()));
  std::array<Histogram, kSeamLevels> histograms;
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const int twin = mesh.twin[idx(h)];
    if (h > twin || is_joined(mesh, unwrap, h)) continue;
    const Vector2d a = unwrap.uv[idx(h)], b = unwrap.uv[idx(next(h))];
    const Vector2d c = unwrap.uv[idx(next(twin))], d = unwrap.uv[idx(twin)];
    const double length = (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).norm();
    for (int level = 0; level < levels; ++level) {
      const double texels = image.width * (b - a).norm() / (1 << level);
      const int steps = std::max(1, static_cast<int>(std::ceil(2 * texels)));
      for (int i = 0; i < steps; ++i) {
        const double t = (i + 0.5) / steps;
        const Vector2d p = a + t * (b - a), q = c + t * (d - c);
        const auto color = [&](const Vector2d& uv) {
          return stored(sample(pyramid.levels[idx(level)], clamped, uv.cast<float>()));
        };
        Contrast own;
        insides.add(chart[idx(face_of(h))], p, level, own);
        insides.add(chart[idx(face_of(twin))], q, level, own);
        const Eigen::Array3f jump = (color(p) - color(q)).abs() - own.width();
        histograms[idx(level)].add(std::max(0.0F, jump.maxCoeff()), length / steps);
      }
    }
  }
  std::array<double, kSeamLevels> result{};
  constexpr double kShare = 0.95;
  std::transform(histograms.begin(), histograms.end(), result.begin(), [](const Histogram& h) {
    return h.quantile(kShare);
  });
  return result;
}

}  // namespace crosspatch
