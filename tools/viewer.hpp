#pragma once

#include <string_view>

namespace crosspatch {

/// The program of the report's page, one JavaScript text with three.js inside; empty in a build
/// that was made without three.js.
std::string_view viewer_script();

}  // namespace crosspatch
