#pragma once

#include <cstdint>
#include <vector>

#include "transfer/image_codec.hpp"

namespace crosspatch {

/// How alike two pictures are.
struct ImageSimilarity {
  double psnr = 0;  ///< dB, over red, green and blue as stored; infinite if they are the same
  double ssim = 0;  ///< of the luma, at most 1
};

/// Compares two pictures of one size and with three or four channels, where `covered` (a value a
/// pixel) is not 0. NaN if nothing is covered.
///
/// SSIM: Wang et al. 2004, "Image quality assessment: from error visibility to structural
/// similarity", Sec. III-B: Gaussian window of 11 x 11 pixels with standard deviation 1.5, K1 =
/// 0.01, K2 = 0.03, mean over the pixels. Differs: pixels that are not covered have no weight in a
/// window, whose other weights grow in proportion.
ImageSimilarity image_similarity(const RasterImage& a,
                                 const RasterImage& b,
                                 const std::vector<std::uint8_t>& covered);

}  // namespace crosspatch
