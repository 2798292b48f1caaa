#pragma once

#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace crosspatch {

/// A pair of corresponding vertices in the numbering of the two files.
struct FileLandmark {
  int source_vertex = 0;
  int target_vertex = 0;
};

/// Reads a landmarks file: two columns `source_vertex target_vertex`, 0-based; blank lines and what
/// follows a `#` are passed over. kBadInput with the line's number: another form, a vertex out of
/// range, a vertex that an earlier line already names.
Result<std::vector<FileLandmark>> parse_landmarks(std::string_view text,
                                                  int source_vertices,
                                                  int target_vertices);

}  // namespace crosspatch
