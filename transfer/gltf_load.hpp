#pragma once

#include <filesystem>
#include <map>
#include <string_view>
#include <vector>

#include "core/file_bytes.hpp"

namespace tinygltf {
class Model;
}

namespace crosspatch {

/// Parses the checked bytes of a glTF file into `model`; images are not decoded, their encoded
/// bytes go to `images` by the file's image index, what was passed over to `notes`. Files named
/// inside are read from `folder` and below only. kBadInput as read_gltf.
Status load_gltf(std::string_view bytes,
                 const std::filesystem::path& folder,
                 const ReadLimits& limits,
                 tinygltf::Model& model,
                 std::map<int, std::vector<unsigned char>>& images,
                 std::vector<std::string>& notes);

}  // namespace crosspatch
