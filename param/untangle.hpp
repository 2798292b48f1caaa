#pragma once

#include <vector>

#include "core/progressive_mesh.hpp"

namespace crosspatch {

/// Number of faces with det(x0, x1, x2) <= 0.
int turned_faces(const MatrixX3i& F, const MatrixX3d& X);

/// Area of the unit sphere that the faces cover, turned ones counted negative.
double covered_area(const MatrixX3i& F, const MatrixX3d& X);

/// How often the faces cover the sphere, counted with their signs: 1 for an embedding. Where no
/// face is turned over and the degree is 1, the triangulation is an embedding.
int degree(const MatrixX3i& F, const MatrixX3d& X);

/// Collapses vertices of faces that are turned over on the sphere until none is: what is left is an
/// embedding, and splitting the vertices again inside the kernels of their rings (refine_on_sphere)
/// puts them back in order. `X` (#V x 3, unit rows) is not changed; vertices with `fixed` stay.
/// Keeps the degree.
/// False if some faces stay turned.
bool collapse_turned_faces(const MatrixX3d& X, const std::vector<bool>& fixed, Refinement& level);

}  // namespace crosspatch
