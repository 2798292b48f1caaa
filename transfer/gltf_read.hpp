#pragma once

#include <filesystem>

#include "core/file_bytes.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// Reads the meshes of a glTF 2.0 file, .gltf or .glb, as one soup.
///
/// Vertices are numbered through the file: nodes in their order in the file, of those that the
/// scene shows and that have a mesh; then primitives in order; then the elements of POSITION. Every
/// triangle is a polygon, those of strips and fans as glTF 2.0 section 3.7.2.1 lists them.
/// Positions are those of the first mesh node's own coordinates, and node_transform is its
/// transform to the scene; meshes of further nodes are brought there. Skinned meshes are taken in
/// their bind pose. Texture coordinates, colours and normals that a primitive lacks are NaN, white
/// and NaN. Images keep their encoded bytes. Buffers and images outside the file must lie in its
/// folder or below; an image that cannot be found is passed over with a note.
///
/// kBadInput: GLB lengths that do not fit, JSON too large, too deep or not sound, an index or byte
/// range outside what it refers to, a node cycle, a required extension that is not known, a missing
/// or misplaced buffer, an unusable image header, a coordinate that is not finite, no triangle, a
/// limit exceeded.
Result<PolygonSoup> read_gltf(const std::filesystem::path& path, const ReadLimits& limits = {});

}  // namespace crosspatch
