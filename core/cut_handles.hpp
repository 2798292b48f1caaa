#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// A surface cut open along closed paths of edges. Faces keep their numbers and vertices too;
/// copies of vertices on the paths come after them.
struct CutMesh {
  TriangleMesh mesh;
  std::vector<int> vertex;              ///< per vertex: the given mesh's vertex
  std::vector<std::vector<int>> loops;  ///< the paths, as vertices of the given mesh
};

/// Cuts every handle, along a closed path that does not separate the surface and is about as short
/// as possible, so that genus 0 is left; each cut leaves two boundary loops. Boundary loops that
/// were there before stay as they are. Source: paths by tree and cotree of Erickson & Whittlesey
/// 2005, "Greedy optimal homotopy and homology generators", from a sample of base points. Cost: a
/// handle takes at most 64 shortest path trees, fewer where there are many. Errors of make_mesh.
Result<CutMesh> cut_handles(const TriangleMesh& mesh);

}  // namespace crosspatch
