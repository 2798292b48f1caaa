#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace crosspatch {

/// The folder of real meshes: $CROSSPATCH_DATA, else ../shared/data beside the source folder; empty
/// when there is none, and tests that need it skip themselves.
inline std::optional<std::filesystem::path> data_folder() {
  std::filesystem::path folder = std::filesystem::path(CROSSPATCH_SOURCE) / "../shared/data";
  if (const char* named = std::getenv("CROSSPATCH_DATA")) folder = named;
  std::error_code ec;
  if (!std::filesystem::is_directory(folder, ec)) return std::nullopt;
  return folder;
}

}  // namespace crosspatch
