#pragma once

#include "core/mesh.hpp"

namespace crosspatch {

/// A surface whose boundary loops are closed by caps. The vertices and faces of the open surface
/// come first and keep their numbers.
struct FilledMesh {
  TriangleMesh mesh;
  int vertex_count = 0;  ///< of the open surface
  int face_count = 0;    ///< of the open surface
  int holes = 0;

  [[nodiscard]] bool was_open() const { return holes > 0; }
};

/// Closes every boundary loop: one of three edges by a triangle, a longer one by a fan around a new
/// vertex in the middle of its corners. Caps are there for the topology, not for looks: they may
/// cut through the surface. Errors of make_mesh.
Result<FilledMesh> fill_holes(const TriangleMesh& mesh);

}  // namespace crosspatch
