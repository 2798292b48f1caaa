#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// A triangle of the surface laid flat, as the measure for its image in the plane.
struct RestTriangle {
  Eigen::Matrix2d inverse_edges;  ///< inverse of the columns (p1 - p0, p2 - p0)
  double area = 0;
};

/// The triangles of `mesh` scaled by `scale`. A triangle flatter than 1e-4 of its longest edge, or
/// smaller than 1e-6 of the mean size, is thickened to that, so that every measure stays finite.
std::vector<RestTriangle> rest_triangles(const TriangleMesh& mesh, double scale = 1);

/// One triangle's part sqrt(A) (J, J^-1) of the symmetric Dirichlet energy A (|J|^2 + |J^-1|^2), J
/// the 2 x 2 Jacobian from the rest triangle to the plane. Matrices are listed row by row.
struct DirichletTerm {
  Eigen::Matrix<double, 8, 1> residual;
  Eigen::Matrix<double, 8, 4> by_jacobian;  ///< derivatives by the entries of J
};

/// Jacobian of the map of `rest` to the plane triangle (a, b, c).
Eigen::Matrix2d jacobian(const RestTriangle& rest,
                         const Vector2d& a,
                         const Vector2d& b,
                         const Vector2d& c);

/// Precondition: det J > 0.
DirichletTerm symmetric_dirichlet(const RestTriangle& rest, const Eigen::Matrix2d& J);

/// Row k holds the derivatives of J(i, 0) and J(i, 1) by coordinate i of corner k, the same for
/// both coordinates.
Eigen::Matrix<double, 3, 2> corner_gradients(const RestTriangle& rest);

/// Sum over the triangles of A (|J|^2 + |J^-1|^2) divided by the sum of A: 4 for an isometry,
/// infinite where a triangle has no positive image.
double symmetric_dirichlet_energy(const std::vector<RestTriangle>& rest,
                                  const MatrixX3i& F,
                                  const MatrixX2d& uv);

/// Larger and smaller singular value of J.
Vector2d singular_values(const Eigen::Matrix2d& J);

}  // namespace crosspatch
