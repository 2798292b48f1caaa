#pragma once

#include <algorithm>

#include "transfer/unwrap.hpp"

namespace crosspatch {

struct AtlasOptions {
  int size = 2048;  ///< texels a side of the images that will be baked, at least 16
  /// Texels kept free around each chart: two texels of mip level 3 where the image is large enough,
  /// so that levels up to that one do not mix charts.
  [[nodiscard]] int padding() const { return std::clamp(size / 64, 2, 16); }
};

struct Atlas {
  Unwrap unwrap;
  int charts = 0;
  double used = 0;  ///< share of the image inside charts
};

/// Cuts `mesh` into charts, lays them flat, and packs them into the unit square, all at one scale:
/// every part of the surface gets texels by its area. Charts that overlap themselves are cut
/// further. Charts go into the gaps that larger ones left.
/// kNumerical if the charts do not fit even when each is smaller than a texel.
Result<Atlas> make_atlas(const TriangleMesh& mesh, const AtlasOptions& options = {});

}  // namespace crosspatch
