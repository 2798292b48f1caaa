#pragma once

#include <array>

#include "transfer/bake.hpp"
#include "transfer/unwrap.hpp"

namespace crosspatch {

/// What a bake adds to the differences across the seams of `unwrap`: how far the bilinear colours
/// of `image` (square) on the two sides of a place are apart, beyond the contrast that the source
/// itself has there. That is the range of the colours inside of the two charts, gutters left out,
/// within one and a half to two texels of the level: they come from the source alone, so that a
/// seam along one of its colour edges, or through a fine pattern, counts for nothing. In 255ths of
/// the stored (sRGB) value: the largest over red, green and blue, at 95 % of the seams' length, for
/// each mip level.
std::array<double, kSeamLevels> seam_error(const RasterImage& image,
                                           const TriangleMesh& mesh,
                                           const Unwrap& unwrap);

}  // namespace crosspatch
