#include "transfer/seam_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.hpp"
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

}  // namespace

std::array<double, kSeamLevels> seam_error(const RasterImage& image,
                                           const TriangleMesh& mesh,
                                           const Unwrap& unwrap) {
  const TexturePyramid pyramid = make_pyramid(image, ColorSpace::kSrgb, Alpha::kIgnored);
  TextureRef clamped;
  clamped.wrap_s = clamped.wrap_t = kClamp;
  constexpr int kBins = 256 * 16;
  std::array<std::vector<double>, kSeamLevels> lengths;
  for (auto& histogram : lengths) histogram.assign(kBins, 0.0);
  double total = 0;
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const int twin = mesh.twin[idx(h)];
    if (h > twin || is_joined(mesh, unwrap, h)) continue;
    const Vector2d a = unwrap.uv[idx(h)], b = unwrap.uv[idx(next(h))];
    const Vector2d c = unwrap.uv[idx(next(twin))], d = unwrap.uv[idx(twin)];
    const double length = (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(2 * image.width * (b - a).norm())));
    for (int i = 0; i < steps; ++i) {
      const double t = (i + 0.5) / steps;
      const Eigen::Vector2f p = (a + t * (b - a)).cast<float>();
      const Eigen::Vector2f q = (c + t * (d - c)).cast<float>();
      for (std::size_t level = 0; level < std::min<std::size_t>(kSeamLevels, pyramid.levels.size());
           ++level) {
        const float difference = (stored(sample(pyramid.levels[level], clamped, p)) -
                                  stored(sample(pyramid.levels[level], clamped, q)))
                                     .abs()
                                     .maxCoeff();
        lengths[level][std::min<std::size_t>(
            kBins - 1, static_cast<std::size_t>(difference * 16))] += length / steps;
      }
    }
    total += length;
  }
  std::array<double, kSeamLevels> result{};
  for (std::size_t level = 0; level < kSeamLevels; ++level) {
    double sum = 0;
    for (std::size_t bin = 0; bin < kBins && sum < 0.95 * total; ++bin) {
      sum += lengths[level][bin];
      result[level] = static_cast<double>(bin + 1) / 16;
    }
  }
  return result;
}

}  // namespace crosspatch
