#pragma once

#include <span>
#include <string_view>

#include "core/file_bytes.hpp"

namespace crosspatch {

/// A glTF file taken apart, before any of it is believed.
struct GltfChunks {
  std::string_view json;
  bool is_binary = false;   ///< GLB
  std::string_view binary;  ///< GLB's BIN chunk, may be empty
};

/// Finds the chunks of a GLB file, or takes the whole as JSON. kBadInput: header cut short, a
/// version other than 2, lengths that do not fit the file.
Result<GltfChunks> split_gltf(std::string_view bytes);

/// Checks what the glTF parser takes on trust: size, depth and number of JSON values; that
/// sections are arrays of objects, that every index into another section is in range, that buffer
/// views lie inside their buffers and no required extension is missing here. kBadInput names the
/// place.
Status check_gltf_json(const GltfChunks& chunks, const ReadLimits& limits);

}  // namespace crosspatch
