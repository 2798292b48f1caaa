#pragma once

#include <string>
#include <string_view>

namespace crosspatch {

/// The bytes in the base64 alphabet of RFC 4648, padded.
std::string base64(std::string_view bytes);

}  // namespace crosspatch
