#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// A mesh that was cut open along edges. Faces keep their numbers; copies of vertices come after
/// all vertices.
struct OpenedMesh {
  TriangleMesh mesh;
  std::vector<int> vertex;  ///< per vertex: the given mesh's vertex
};

/// Gives both sides of the marked edges vertices of their own. `marked`: per half-edge, the same
/// for twins. Corners that meet across other edges stay one vertex; the first of them keeps the
/// number. Errors of make_mesh.
Result<OpenedMesh> open_along(const TriangleMesh& mesh, const std::vector<bool>& marked);

}  // namespace crosspatch
