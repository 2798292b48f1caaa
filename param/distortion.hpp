#pragma once

#include "core/types.hpp"

namespace crosspatch {

/// What is minimised, in the singular values s1, s2 of the Jacobian of a face.
enum class Distortion {
  kSymmetricDirichlet,  ///< s1^2 + s2^2 + 1/s1^2 + 1/s2^2
  /// (1 + s1 s2) / 2 times that, the energy of the map and of its inverse, each weighted by the
  /// area of its own surface, less 2 (s1 s2 - 1), which sums to nothing when all of the target is
  /// covered: without it isometries would not be least, and faces whose lifted corners cut short
  /// over edges of the target would be sought (a mesh mapped to itself slips by 0.4 % of the root
  /// of its area). Least for isometries: 4. With kSymmetricDirichlet a limb may slip off its
  /// counterpart, whose end a few stretched faces cover at hardly any cost.
  kBothWays,
  /// s1/s2 + s2/s1 + log(s1 s2)^2 / 10: for embeddings. Nearly conformal, so that great-circle
  /// edges are nearly straight on the surface, but without the exponential shrinking of long limbs,
  /// in whose wake optimisers creep. Measured: with the symmetric Dirichlet energy instead a tenth
  /// of a human map's area has energies above 35 (from 17), with a weight of 1/200 limbs slip (mean
  /// error 10 from 3 on a FAUST pair).
  kNearlyConformal,
};

/// Distortion of one face with lifted corners y; infinite where it has no area.
double distortion(Distortion distortion,
                  const Eigen::Matrix2d& rest_inverse,
                  const Vector3d& y0,
                  const Vector3d& y1,
                  const Vector3d& y2);

/// Value, gradient and positive semidefinite Hessian of a distortion as functions of the entries of
/// J (column by column).
struct IsotropicHessian {
  double energy;
  Eigen::Vector4d g;
  Eigen::Matrix4d H;
};

/// The entries of a 2 x 2 matrix, column by column.
inline Eigen::Vector4d vec(const Eigen::Matrix2d& m) {
  return {m(0, 0), m(1, 0), m(0, 1), m(1, 1)};
}

/// Smith, de Goes & Kim 2019, "Analytic eigensystems for isotropic distortion energies": with J = U
/// diag(s) V^T the Hessian acts on the span of u_i v_i^T as the Hessian in s, and has the
/// eigenmatrices (u_1 v_2^T + u_2 v_1^T) / sqrt(2) and (u_2 v_1^T - u_1 v_2^T) / sqrt(2). Negative
/// eigenvalues are replaced by zero.
IsotropicHessian isotropic_hessian(const Eigen::Matrix2d& J, Distortion distortion);

}  // namespace crosspatch
