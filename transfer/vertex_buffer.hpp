#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "transfer/textured_mesh.hpp"

namespace crosspatch {

/// The triangles of one material as graphics hardware wants them: single precision, one index for
/// all attributes, every vertex once.
///
/// Invariants: (1) `normals`, every UV set, `colors` (unless empty), `tangents` (unless empty)
/// and `rows` have one entry a position; (2) three indices a triangle, none of them flat; (3) every
/// vertex is used; (4) normals and the first three entries of tangents have length 1.
struct VertexBuffer {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 3>> normals;
  std::vector<std::vector<std::array<float, 2>>> uv_sets;
  std::vector<std::array<float, 4>> colors;
  std::vector<std::array<float, 4>> tangents;  ///< w = 1 or -1: side of the bitangent
  std::vector<int> rows;                       ///< of the mesh's positions
  std::vector<std::uint32_t> indices;
};

/// Welds the corners of the triangles of `material` that agree in every attribute, and in their
/// position's row if the mesh moves; vertices in order of first use. Triangles two corners of which
/// single precision makes one are left out: they have no extent, and their neighbours close up.
///
/// With `tangent_uv_set` each vertex gets a tangent along increasing u of that set, see
/// corner_tangents.
VertexBuffer weld_corners(const TexturedMesh& mesh, int material, int tangent_uv_set = -1);

}  // namespace crosspatch
