#pragma once

#include "core/mesh.hpp"

namespace crosspatch {

struct LaplacianOptions {
  /// Least slack of the triangle inequalities, in mean edge lengths (Sharp & Crane 2020 use 1e-5);
  /// 0 leaves the lengths alone.
  double mollify = 1e-5;
  /// Cotangents of the intrinsic Delaunay triangulation: no negative weights, so that the maximum
  /// principle holds whatever the triangles look like.
  bool delaunay = true;
};

/// The cotangent Laplacian of a surface with Neumann boundary.
struct Laplacian {
  /// Stiffness, #V x #V, positive semidefinite: u^T L u is the Dirichlet energy; dimensionless.
  /// L(i, j) = -(cot a + cot b) / 2. Never clamped.
  SparseMatrix L;
  Eigen::VectorXd mass;  ///< #V, a third of the area of the faces around a vertex; positive
  double mollification;  ///< length added to each edge
  int flips;             ///< edges flipped to reach the intrinsic Delaunay triangulation
};

/// Assembles the Laplacian of `mesh`. kBadInput if its edges have no length, or a vertex has no
/// area although mollified.
Result<Laplacian> compute_laplacian(const TriangleMesh& mesh, const LaplacianOptions& options = {});

}  // namespace crosspatch
