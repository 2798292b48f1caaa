#include "transfer/texels_in_use.hpp"

#include <algorithm>

#include "core/index.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {

std::vector<bool> texels_in_use(const TexturedMesh& mesh,
                                Channel channel,
                                int image,
                                std::array<int, 2> size) {
  constexpr double kRounding = 1e-5;
  const auto [width, height] = size;
  const Vector2d scale(width, height);
  std::vector<bool> used(idx(width) * idx(height), false);
  std::vector<std::array<int, 2>> middles;  // of triangles without any centre
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const TextureRef& ref = texture_of(mesh.materials[idx(mesh.material[idx(t)])], channel);
    if (ref.image != image) continue;
    std::array<Vector2d, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector2d uv = transformed(mesh.uv_sets[idx(ref.uv_set)][idx(3 * t) + k], ref.transform);
      if (uv.minCoeff() < -kRounding || uv.maxCoeff() > 1 + kRounding) return {};
      corner[k] = uv.cwiseProduct(scale);
    }
    bool found = false;
    for_each_span(corner, 0, {0, height}, width, [&](const TexelSpan& span) {
      const auto row = used.begin() + static_cast<std::ptrdiff_t>(idx(span.y) * idx(width));
      std::fill(row + span.left, row + span.right + 1, true);
      found = true;
    });
    if (found) continue;
    const Vector2d middle = (corner[0] + corner[1] + corner[2]) / 3;
    middles.push_back({std::clamp(static_cast<int>(middle[0]), 0, width - 1),
                       std::clamp(static_cast<int>(middle[1]), 0, height - 1)});
  }
  // Beside texels in use these are slivers at the rim of an island: outside of it, for all we know.
  const auto is_alone = [&](const std::array<int, 2>& p) {
    for (int y = std::max(0, p[1] - 1); y <= std::min(height - 1, p[1] + 1); ++y)
      for (int x = std::max(0, p[0] - 1); x <= std::min(width - 1, p[0] + 1); ++x)
        if (used[idx(y) * idx(width) + idx(x)]) return false;
    return true;
  };
  std::erase_if(middles, [&](const std::array<int, 2>& p) { return !is_alone(p); });
  for (const auto& [x, y] : middles) used[idx(y) * idx(width) + idx(x)] = true;
  return used;
}

}  // namespace crosspatch
