#pragma once

#include <string>

#include "core/result.hpp"
#include "transfer/textured_mesh.hpp"
#include "transfer/write_mesh_files.hpp"

namespace crosspatch {

/// The mesh as a binary glTF 2.0 file (GLB): one node with the mesh's transform, one primitive a
/// material in use, images in buffer views with their original bytes.
///
/// Writes positions, normals, every UV set, vertex colours, and tangents where the material has a
/// normal map; joints, weights and morph targets with their skeleton and animations; samplers,
/// factors, alpha mode, and KHR_texture_transform where used. Materials and images nothing refers
/// to are left out. kInternal when `mesh` breaks an invariant; kOutput when there is no triangle,
/// an image in use is neither PNG nor JPEG, or the file would pass 4 GiB.
Result<std::string> encode_glb(const TexturedMesh& mesh);

/// The same as JSON "STEM.gltf", its buffer "STEM.bin" and images "STEM_NAME" beside it. Images
/// must have names that differ.
Result<std::vector<NamedBytes>> encode_gltf(const TexturedMesh& mesh, const std::string& stem);

}  // namespace crosspatch
