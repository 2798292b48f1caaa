#pragma once

#include <optional>

#include "core/soup.hpp"

namespace crosspatch {

struct ImageSize {
  int width = 0;
  int height = 0;
};

/// Width and height in texels from the header of a PNG or JPEG file, nothing decoded. Empty when
/// the bytes are neither or are cut short.
std::optional<ImageSize> image_size(const ImageFile& image);

}  // namespace crosspatch
