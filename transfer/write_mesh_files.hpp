#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

enum class MeshFormat {
  kGlb,   ///< one file with everything inside
  kGltf,  ///< JSON, a buffer and images beside it
  kObj,   ///< OBJ, MTL and images; the first UV set, no vertex colours, no tangents
  kPly,   ///< binary PLY with the base colour at the vertices, 8-bit sRGB
};

/// The format that a file name's extension stands for, whatever its case.
std::optional<MeshFormat> mesh_format(const std::string& file_name);

/// A file to be written: its name without folder, and its bytes.
struct NamedBytes {
  std::string name;
  std::string bytes;
};

/// The mesh as files: `name` (without folder) first, then those it refers to, whose names start
/// with its stem. The node transform is written by glTF and applied to the places by the others.
/// kOutput: no format has this extension, there is no triangle, or the format cannot hold an image
/// unchanged; kBadInput: PLY, when an image cannot be decoded; kInternal when `mesh` breaks an
/// invariant.
Result<std::vector<NamedBytes>> encode_mesh_files(const TexturedMesh& mesh,
                                                  const std::string& name);

}  // namespace crosspatch
