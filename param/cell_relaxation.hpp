#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// Moves vertices of `mesh` on the sphere, one at a time inside the kernels of their rings, to
/// where the cells of the common subdivision with `other` have less energy: the symmetric Dirichlet
/// energy |J|^2 + |J^-1|^2, weighted by the mean of a cell's areas on both surfaces, as measure_map
/// has it but with slivers thickened (see thickened_sides). It sees what happens inside faces,
/// where energies that are judged at lifted corners are blind. Only vertices around which the mean
/// energy is above 5 (isometry: 4) are tried. No face is turned over, and no energy rises. `X` and
/// `Y` (#V x 3, unit rows) embed the meshes, closed surfaces of area 1; `pinned` vertices stay.
/// Returns by how much the mean energy falls; the same for any number of threads.
double relax_cells(const TriangleMesh& mesh,
                   const TriangleMesh& other,
                   const MatrixX3d& Y,
                   const std::vector<int>& pinned,
                   MatrixX3d& X);

/// A mesh that moves on the sphere: its unit rows (#V x 3), and the vertices that stay.
struct MovingMesh {
  const TriangleMesh& mesh;
  const std::vector<int>& pinned;
  MatrixX3d& X;
};

/// The same for the vertices of either mesh in turn, until a round gains less than
/// `worthwhile` or `rounds` have passed. A vertex is tried again only where something near it has
/// moved since. Returns the sum of what was gained.
double relax_cells(const MovingMesh& a, const MovingMesh& b, int rounds, double worthwhile);

}  // namespace crosspatch
