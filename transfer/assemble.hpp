#pragma once

#include "transfer/overlay_mesh.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

/// Name of the material of triangles that nothing is mapped to.
constexpr const char* kUnmappedMaterial = "unmapped";

/// The overlay as a mesh for export: materials and images of `source`, places, normals and node
/// transform of `target`. Triangles keep their order. Those without a map get the grey material
/// "unmapped", mapped ones without a material the white one "default".
TexturedMesh assemble(const AttributedMesh& source,
                      const AttributedMesh& target,
                      const SourceAttributes& attributes,
                      const OverlayMesh& overlay);

/// Unit normals per corner of the prepared mesh, 3 #F: those of its file, else area-weighted ones.
std::vector<Vector3d> corner_normals(const AttributedMesh& mesh);

}  // namespace crosspatch
