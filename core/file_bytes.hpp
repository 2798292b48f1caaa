#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace crosspatch {

/// What a file may ask of us before it is believed.
struct ReadLimits {
  std::uint64_t max_file_bytes = std::uint64_t{1} << 31;  ///< ours: 20 M ASCII triangles fit
  std::int64_t max_triangles = 20'000'000;  ///< after fanning; corners then stay below 2^31
  std::int64_t max_vertices = 60'000'000;   ///< three a triangle, as in STL
  std::uint64_t max_image_bytes = std::uint64_t{1} << 28;  ///< encoded
  std::int64_t max_image_side = 16384;                     ///< texels
  std::int64_t max_image_texels = std::int64_t{1} << 28;   ///< 16384 x 16384
  std::uint64_t max_json_bytes = std::uint64_t{1} << 28;   ///< data URIs included
  int max_json_depth = 100;                 ///< the parser recurses; real files stay below 20
  std::int64_t max_json_objects = 200'000;  ///< each costs the parser about 1 kB
  std::int64_t max_json_values = 20'000'000;
};

/// The bytes of a regular file. kBadInput: missing, no regular file, larger than `max_bytes`, not
/// readable.
Result<std::vector<unsigned char>> read_file_bytes(const std::filesystem::path& path,
                                                   std::uint64_t max_bytes);

/// The path of the existing regular file that `name`, found inside a file, means next to it.
/// Backslashes count as slashes. kBadInput: empty or absolute name, drive or scheme, a `..`, a
/// link that leaves `folder`, no such regular file.
Result<std::filesystem::path> resolve_inside(const std::filesystem::path& folder,
                                             std::string_view name);

/// `text` in quotes for a one-line message: at most 40 characters, unprintable ones as '?'.
std::string in_quotes(std::string_view text);

}  // namespace crosspatch
