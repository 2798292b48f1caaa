#pragma once

#include <filesystem>

#include "core/file_bytes.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// Reads a mesh file of any kind: glTF by the extension .gltf or .glb or by GLB's first bytes
/// (read_gltf), anything else as read_soup.
Result<PolygonSoup> read_mesh_file(const std::filesystem::path& path,
                                   const ReadLimits& limits = {});

}  // namespace crosspatch
