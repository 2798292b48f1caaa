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

/// J = U diag(s1, s2) V^T for det J >= 0, s1 >= s2 >= 0, by J's parts along a rotation and a
/// reflection, without the angles of U and V.
struct Svd2 {
  explicit Svd2(const Eigen::Matrix2d& J) {
    const double sum = (J(0, 0) + J(1, 1)) / 2, difference = (J(0, 0) - J(1, 1)) / 2;
    const double shear = (J(1, 0) + J(0, 1)) / 2, spin = (J(1, 0) - J(0, 1)) / 2;
    const double turning = std::sqrt(sum * sum + spin * spin);
    const double mirroring = std::sqrt(difference * difference + shear * shear);
    s1 = turning + mirroring;
    s2 = s1 > 0 ? std::max(0.0, J.determinant()) / s1 : 0;
    const Vector2d r = turning > 0 ? Vector2d(sum / turning, spin / turning) : Vector2d::UnitX();
    const Vector2d m =
        mirroring > 0 ? Vector2d(difference / mirroring, shear / mirroring) : Vector2d::UnitX();
    rotation << r[0], -r[1], r[1], r[0];
    reflection << m[0], m[1], m[1], -m[0];
    turned << -r[1], -r[0], r[0], -r[1];
    turned_reflection << -m[1], m[0], m[0], m[1];
  }
  double s1, s2;
  Eigen::Matrix2d rotation;           ///< U V^T
  Eigen::Matrix2d reflection;         ///< U diag(1, -1) V^T
  Eigen::Matrix2d turned;             ///< U [0 -1; 1 0] V^T
  Eigen::Matrix2d turned_reflection;  ///< U [0 1; 1 0] V^T
};

/// S without its negative eigenvalues.
Eigen::Matrix2d positive_part(const Eigen::Matrix2d& S) {
  if (S(0, 0) >= 0 && S(1, 1) >= 0 && S.determinant() >= 0) return S;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(S);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

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
  const double s1 = std::max(svd.s1, kTiny), s2 = std::max(svd.s2, kTiny);
  const SingularDerivatives d = distortion == Distortion::kBothWays ? both_ways_derivatives(s1, s2)
                                : distortion == Distortion::kSymmetricDirichlet
                                    ? symmetric_dirichlet_derivatives(s1, s2)
                                    : nearly_conformal_derivatives(s1, s2);
  Eigen::Matrix<double, 4, 2> D;  // the Jacobian's derivatives in the singular values
  D << vec((svd.rotation + svd.reflection) / 2), vec((svd.rotation - svd.reflection) / 2);
  const Eigen::Vector4d flip = vec(svd.turned_reflection) / std::sqrt(2.0),
                        twist = vec(svd.turned) / std::sqrt(2.0);
  Eigen::Matrix2d S;
  S << d.d11, d.d12, d.d12, d.d22;
  return {d.energy,
          D * Vector2d(d.d1, d.d2),
          D * positive_part(S) * D.transpose() + std::max(0.0, d.flip) * flip * flip.transpose() +
              std::max(0.0, d.twist) * twist * twist.transpose()};
}

}  // namespace crosspatch
