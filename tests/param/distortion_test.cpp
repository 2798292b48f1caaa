#include "param/distortion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace crosspatch {
namespace {

constexpr Distortion kAll[] = {
    Distortion::kSymmetricDirichlet, Distortion::kBothWays, Distortion::kNearlyConformal};

double value(Distortion d, const Eigen::Matrix2d& J) {
  return distortion(d,
                    Eigen::Matrix2d::Identity(),
                    Vector3d::Zero(),
                    Vector3d(J(0, 0), J(1, 0), 0),
                    Vector3d(J(0, 1), J(1, 1), 0));
}

/// Jacobians that keep orientation, with singular values of about 0.1 to 3.
std::vector<Eigen::Matrix2d> jacobians() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> entry(-2, 2);
  std::vector<Eigen::Matrix2d> result;
  while (result.size() < 100) {
    Eigen::Matrix2d J;
    for (double& x : J.reshaped()) x = entry(random);
    if (J.determinant() > 0.1) result.push_back(J);
  }
  return result;
}

TEST(Distortion, IsLeastForIsometries) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.8).toRotationMatrix();
  EXPECT_NEAR(value(Distortion::kSymmetricDirichlet, turn), 4, 1e-12);
  EXPECT_NEAR(value(Distortion::kBothWays, turn), 4, 1e-12);
  EXPECT_NEAR(value(Distortion::kNearlyConformal, turn), 2, 1e-12);
  for (const Eigen::Matrix2d& J : jacobians()) {
    EXPECT_GT(value(Distortion::kSymmetricDirichlet, J), 4);
    EXPECT_GT(value(Distortion::kBothWays, J), 4);
    EXPECT_GT(value(Distortion::kNearlyConformal, J), 2);
  }
  // Nor does a scale that is a little smaller pay.
  EXPECT_GT(value(Distortion::kBothWays, 0.99 * turn), 4);
}

TEST(Distortion, BothWaysIsThatOfTheInverseByTheOtherArea) {
  for (const Eigen::Matrix2d& J : jacobians()) {
    // What was taken off sums to nothing over two whole surfaces of one area.
    const double p = J.determinant();
    EXPECT_NEAR(value(Distortion::kBothWays, J) + 2 * (p - 1),
                p * (value(Distortion::kBothWays, J.inverse()) + 2 * (1 / p - 1)),
                1e-8);
  }
}

TEST(IsotropicHessian, AgreesWithDifferences) {
  constexpr double kStep = 1e-6;
  for (const Distortion d : kAll)
    for (const Eigen::Matrix2d& J : jacobians()) {
      const IsotropicHessian h = isotropic_hessian(J, d);
      EXPECT_NEAR(h.energy, value(d, J), 1e-9 * h.energy);
      for (int i = 0; i < 4; ++i) {
        Eigen::Matrix2d more = J, less = J;
        more(i % 2, i / 2) += kStep;
        less(i % 2, i / 2) -= kStep;
        EXPECT_NEAR(h.g[i],
                    (value(d, more) - value(d, less)) / (2 * kStep),
                    1e-5 * std::max(1.0, h.g.norm()));  // steps of 1e-6
      }
      EXPECT_GE(h.H.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-9 * h.H.norm());
    }
  // Where no eigenvalue is negative nothing is replaced.
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.3).toRotationMatrix();
  for (const Distortion d : {Distortion::kSymmetricDirichlet, Distortion::kBothWays})
    for (int i = 0; i < 4; ++i) {
      Eigen::Matrix2d more = turn, less = turn;
      more(i % 2, i / 2) += kStep;
      less(i % 2, i / 2) -= kStep;
      const Eigen::Vector4d difference =
          (isotropic_hessian(more, d).g - isotropic_hessian(less, d).g) / (2 * kStep);
      EXPECT_LT((isotropic_hessian(turn, d).H.col(i) - difference).norm(), 1e-5);
    }
}

}  // namespace
}  // namespace crosspatch
