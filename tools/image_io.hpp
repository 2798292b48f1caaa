#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "tools/bitmap.hpp"

namespace crosspatch {

/// Decodes an image file held in memory (PNG or JPEG, told by its first bytes). kBadInput: another
/// format, broken data, or more than 16384 pixels on a side or 128 million altogether, which is
/// checked before any pixel is read. Not for use by several threads at once.
Result<Bitmap> decode_image(const std::vector<unsigned char>& bytes);

/// The bitmap's colours as the bytes of a PNG file, 8 bits RGB. kOutput when the encoder fails.
Result<std::vector<unsigned char>> encode_png(const Bitmap& bitmap);

}  // namespace crosspatch
