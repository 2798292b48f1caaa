#pragma once

#include <span>
#include <string>

#include "core/file_bytes.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// What the header of an encoded image says.
struct ImageHeader {
  int width = 0;          ///< texels
  int height = 0;         ///< texels
  std::string mime_type;  ///< "image/png" or "image/jpeg"
};

/// Reads the header of a PNG or JPEG without decoding it, so that a decoder is only started on
/// images it can hold. kBadInput: neither of the two, header cut short or out of order, a side or
/// the area is zero or above `limits`.
Result<ImageHeader> sniff_image(std::span<const unsigned char> bytes,
                                const ReadLimits& limits = {});

/// Wraps encoded bytes: mime type by content. kBadInput as sniff_image for PNG and JPEG; other
/// content passes with an empty mime type.
Result<ImageFile> make_image_file(std::string name,
                                  std::vector<unsigned char> bytes,
                                  const ReadLimits& limits = {});

}  // namespace crosspatch
