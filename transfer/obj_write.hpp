#pragma once

#include "transfer/write_mesh_files.hpp"

namespace crosspatch {

/// OBJ, MTL and images, see MeshFormat::kObj. OBJ's v grows upwards and is turned on writing.
std::vector<NamedBytes> encode_obj(const TexturedMesh& mesh, const std::string& stem);

/// See MeshFormat::kPly.
Result<std::string> encode_ply(const TexturedMesh& mesh);

}  // namespace crosspatch
