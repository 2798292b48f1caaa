#pragma once

#include <vector>

#include "param/distortion.hpp"
#include "param/lift.hpp"

namespace crosspatch {

/// A triangulation of a surface, free to move on the sphere, whose faces carry the shape they
/// should have after the lift.
struct SphereProblem {
  MatrixX3i F;  ///< #F x 3 over the rows of X
  std::vector<Eigen::Matrix2d>
      rest_inverse;           ///< per face: inverse of the 2 x 2 matrix of its rest edges
  Eigen::VectorXd rest_area;  ///< per face
  /// Per face: the value of det(x0, x1, x2) it is held against by the barrier. make_sphere_problem
  /// sets that of a face with its share of the sphere's area.
  Eigen::VectorXd reference_orientation;
  std::vector<bool> fixed;  ///< per vertex
  /// Fields the lift's fields should agree with (#V x fields; not owned), or none; `field_weight`
  /// times the area-weighted mean of the squared differences is added to the energy.
  const Eigen::MatrixXd* fields = nullptr;
  double field_weight = 0;
};

/// The triangle with sides `u` and `v` laid out in the plane, these in the columns; slivers are
/// thickened to a height of a fiftieth of their longest edge, because the energy of a flatter
/// triangle says nothing about the surface.
Eigen::Matrix2d thickened_sides(const Vector3d& u, const Vector3d& v);

/// The faces `F` with the shapes they have in `V`, slivers thickened; `pinned` vertices do not
/// move.
SphereProblem make_sphere_problem(MatrixX3i F, const MatrixX3d& V, const std::vector<int>& pinned);

struct SphereOptimizerOptions {
  Distortion distortion = Distortion::kBothWays;
  int max_iterations = 30;
  double relative_decrease = 1e-4;  ///< stop when an iteration gains less
  /// Weight of reference_orientation over the present one: keeps faces from being flattened on the
  /// sphere where the lift hides it. For kNearlyConformal the reference is twice the area of the
  /// face's chord triangle.
  double barrier = 1e-3;
};

struct SphereOptimizerReport {
  int iterations = 0;
  double energy_before = 0;  ///< area-weighted mean distortion, with the barrier (isometry: 4)
  double energy_after = 0;
};

/// Moves the rows of `X` (unit vectors) downhill in the symmetric Dirichlet energy |J|^2 + |J^-1|^2
/// of the maps from the rest faces to the lifted ones, by projected Newton steps with a global
/// backtracking line search; no face ever turns over on the sphere. `hint` (#V) holds a face of the
/// lift for each vertex, kept up to date. Precondition: every face of F is positively oriented in
/// X.
SphereOptimizerReport optimize_on_sphere(const SphereProblem& problem,
                                         const Lift& lift,
                                         const SphereOptimizerOptions& options,
                                         MatrixX3d& X,
                                         std::vector<int>& hint);

/// Smallest orientation det(x0, x1, x2) of the faces, in the double arithmetic of the optimiser.
double smallest_orientation(const MatrixX3i& F, const MatrixX3d& X);

}  // namespace crosspatch
