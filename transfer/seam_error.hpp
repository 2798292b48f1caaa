#pragma once

#include <array>

#include "transfer/bake.hpp"
#include "transfer/unwrap.hpp"

namespace crosspatch {

/// Differences of a colour image, bilinear, on the two sides of the seams of `unwrap`, in 255ths of
/// the stored (sRGB) value: the largest over red, green and blue, at 95 % of the seams' length,
/// for each mip level.
std::array<double, kSeamLevels> seam_error(const RasterImage& image,
                                           const TriangleMesh& mesh,
                                           const Unwrap& unwrap);

}  // namespace crosspatch
