#include "param/distortion.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace crosspatch {
namespace {

/// First and second derivatives in the singular values, and the eigenvalues (d1 -+ d2) / (s1 -+ s2)
/// in closed form.
struct SingularDerivatives {
  double energy, d1, d2, d11, d22, d12, flip, twist;
};

SingularDerivatives symmetric_dirichlet_derivatives(double s1, double s2) {
  const double i1 = 1 / (s1 * s1), i2 = 1 / (s2 * s2), cube = s1 * s2 * s1 * s2 * s1 * s2;
  return {s1 * s1 + s2 * s2 + i1 + i2,
          2 * s1 - 2 * i1 / s1,
          2 * s2 - 2 * i2 / s2,
          2 + 6 * i1 * i1,
          2 + 6 * i2 * i2,
          0,
          2 + 2 * (s1 * s1 + s1 * s2 + s2 * s2) / cube,
          2 - 2 * (s1 * s1 - s1 * s2 + s2 * s2) / cube};
}

SingularDerivatives both_ways_derivatives(double s1, double s2) {
  const SingularDerivatives q = symmetric_dirichlet_derivatives(s1, s2);
  const double p = s1 * s2;
  return {(1 + p) * q.energy / 2 - 2 * (p - 1),
          (s2 * q.energy + (1 + p) * q.d1) / 2 - 2 * s2,
          (s1 * q.energy + (1 + p) * q.d2) / 2 - 2 * s1,
          (2 * s2 * q.d1 + (1 + p) * q.d11) / 2,
          (2 * s1 * q.d2 + (1 + p) * q.d22) / 2,
          (q.energy + s1 * q.d1 + s2 * q.d2) / 2 - 2,
          ((1 + p) * q.flip - q.energy) / 2 + 2,
          ((1 + p) * q.twist + q.energy) / 2 - 2};
}

/// J = U diag(s1, s2) V^T for det J >= 0, in closed form: U and V are rotations, s1 >= s2 >= 0.
struct Svd2 {
  explicit Svd2(const Eigen::Matrix2d& J) {
    const double sum = (J(0, 0) + J(1, 1)) / 2, difference = (J(0, 0) - J(1, 1)) / 2;
    const double shear = (J(1, 0) + J(0, 1)) / 2, spin = (J(1, 0) - J(0, 1)) / 2;
    s1 = std::hypot(sum, spin) + std::hypot(difference, shear);
    s2 = s1 > 0 ? std::max(0.0, J.determinant()) / s1 : 0;
    const double twice = std::atan2(shear, difference), turn = std::atan2(spin, sum);
    U = Eigen::Rotation2Dd((twice + turn) / 2);
    V = Eigen::Rotation2Dd((twice - turn) / 2);
  }
  Eigen::Matrix2d U, V;
  double s1, s2;
};

/// What kNearlyConformal adds for a scale of areas exp(L), with its derivatives in L.
struct ScalePenalty {
  explicit ScalePenalty(double L) {
    constexpr double kSquare = 1.0 / 200, kReach = 10;
    const double q = L / kReach;
    value = kSquare * L * L + q * q * q * q;
    first = 2 * kSquare * L + 4 * q * q * q / kReach;
    second = 2 * kSquare + 12 * q * q / (kReach * kReach);
  }
  double value, first, second;
};

SingularDerivatives nearly_conformal_derivatives(double s1, double s2) {
  const double p = s1 * s2;
  const ScalePenalty scale(std::log(p));
  return {s1 / s2 + s2 / s1 + scale.value,
          1 / s2 - s2 / (s1 * s1) + scale.first / s1,
          1 / s1 - s1 / (s2 * s2) + scale.first / s2,
          2 * s2 / (s1 * s1 * s1) + (scale.second - scale.first) / (s1 * s1),
          2 * s1 / (s2 * s2 * s2) + (scale.second - scale.first) / (s2 * s2),
          -1 / (s1 * s1) - 1 / (s2 * s2) + scale.second / p,
          (1 - scale.first) / p + (s1 * s1 + p + s2 * s2) / (p * p),
          (1 + scale.first) / p - (s1 * s1 - p + s2 * s2) / (p * p)};
}

}  // namespace

double distortion(Distortion distortion,
                  const Eigen::Matrix2d& D,
                  const Vector3d& y0,
                  const Vector3d& y1,
                  const Vector3d& y2) {
  Eigen::Matrix<double, 3, 2> E;
  E << y1 - y0, y2 - y0;
  const Eigen::Matrix2d G = D.transpose() * (E.transpose() * E) * D;
  const double det = G.determinant();
  if (!(det > 0)) return std::numeric_limits<double>::infinity();
  if (distortion == Distortion::kSymmetricDirichlet) return G.trace() * (1 + 1 / det);
  if (distortion == Distortion::kBothWays)
    return G.trace() * (1 + 1 / det) * (1 + std::sqrt(det)) / 2 - 2 * (std::sqrt(det) - 1);
  return G.trace() / std::sqrt(det) + ScalePenalty(std::log(det) / 2).value;
}

IsotropicHessian isotropic_hessian(const Eigen::Matrix2d& J, Distortion distortion) {
  constexpr double kTiny = 1e-150;
  const Svd2 svd(J);
  const Eigen::Matrix2d &U = svd.U, &V = svd.V;
  const double s1 = std::max(svd.s1, kTiny), s2 = std::max(svd.s2, kTiny);
  const SingularDerivatives d = distortion == Distortion::kBothWays ? both_ways_derivatives(s1, s2)
                                : distortion == Distortion::kSymmetricDirichlet
                                    ? symmetric_dirichlet_derivatives(s1, s2)
                                    : nearly_conformal_derivatives(s1, s2);
  Eigen::Matrix<double, 4, 2> D;
  D << vec(U.col(0) * V.col(0).transpose()), vec(U.col(1) * V.col(1).transpose());
  const Eigen::Vector4d a = vec(U.col(0) * V.col(1).transpose()),
                        b = vec(U.col(1) * V.col(0).transpose());
  const Eigen::Vector4d flip = (a + b) / std::sqrt(2.0), twist = (b - a) / std::sqrt(2.0);
  Eigen::Matrix2d S;
  S << d.d11, d.d12, d.d12, d.d22;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(S);
  const Eigen::Matrix2d positive = eigen.eigenvectors() *
                                   eigen.eigenvalues().cwiseMax(0).asDiagonal() *
                                   eigen.eigenvectors().transpose();
  return {d.energy,
          D * Vector2d(d.d1, d.d2),
          D * positive * D.transpose() + std::max(0.0, d.flip) * flip * flip.transpose() +
              std::max(0.0, d.twist) * twist * twist.transpose()};
}

}  // namespace crosspatch
