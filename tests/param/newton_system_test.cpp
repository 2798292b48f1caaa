#include "param/newton_system.hpp"

#include <gtest/gtest.h>

#include <random>

namespace crosspatch {
namespace {

/// Two triangles that share an edge, given in orders that put both small and large numbers first.
const MatrixX3i kFaces = (MatrixX3i(2, 3) << 2, 0, 1, 1, 3, 2).finished();

/// Positive definite models of two faces.
std::vector<FaceSystem> random_models(std::vector<Eigen::Matrix<double, 6, 6>>& dense) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  std::vector<FaceSystem> models(2);
  for (FaceSystem& model : models) {
    const Eigen::Matrix<double, 6, 6> A =
        Eigen::Matrix<double, 6, 6>::NullaryExpr([&] { return normal(generator); });
    dense.emplace_back(A * A.transpose());
    for (int a = 0; a < 3; ++a) {
      model.g[static_cast<std::size_t>(a)] = Vector2d(normal(generator), normal(generator));
      for (int b = 0; b <= a; ++b)
        model.H[FaceSystem::block(static_cast<std::size_t>(a), static_cast<std::size_t>(b))] =
            dense.back().block<2, 2>(2 * a, 2 * b);
    }
  }
  return models;
}

TEST(NewtonSystem, StepSolvesTheSumOfTheFacesModels) {
  std::vector<Eigen::Matrix<double, 6, 6>> dense;
  const std::vector<FaceSystem> models = random_models(dense);
  const std::vector<int> unknown{2, -1, 0, 4};  // vertex 1 is fixed
  NewtonSystem system(kFaces, unknown);
  system.assemble(models);
  const Eigen::Matrix2d more = 3 * Eigen::Matrix2d::Identity();
  system.add(3, more, Vector2d(1, -2));
  constexpr double kDamping = 0.5;
  const double mean_diagonal = system.mean_diagonal();
  Eigen::VectorXd step;
  ASSERT_TRUE(system.solve(kDamping, step));

  Eigen::MatrixXd H = kDamping * Eigen::MatrixXd::Identity(6, 6);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(6);
  for (int f = 0; f < 2; ++f)
    for (int a = 0; a < 3; ++a) {
      const int i = unknown[static_cast<std::size_t>(kFaces(f, a))];
      if (i < 0) continue;
      g.segment<2>(i) += models[static_cast<std::size_t>(f)].g[static_cast<std::size_t>(a)];
      for (int b = 0; b < 3; ++b)
        if (const int j = unknown[static_cast<std::size_t>(kFaces(f, b))]; j >= 0)
          H.block<2, 2>(i, j) += dense[static_cast<std::size_t>(f)].block<2, 2>(2 * a, 2 * b);
    }
  H.block<2, 2>(4, 4) += more;
  g.segment<2>(4) += Vector2d(1, -2);
  EXPECT_NEAR(mean_diagonal + kDamping, H.trace() / 6, 1e-12);
  EXPECT_LT((system.gradient() - g).norm(), 1e-12);
  EXPECT_LT((H * step + g).norm(), 1e-10 * g.norm());
}

TEST(NewtonSystem, NothingMoves) {
  NewtonSystem system(kFaces, {-1, -1, -1, -1});
  Eigen::VectorXd step;
  EXPECT_FALSE(system.solve(1, step));
}

}  // namespace
}  // namespace crosspatch
