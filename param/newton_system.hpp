#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// A face's quadratic model in the two coordinates of each of its corners.
struct FaceSystem {
  /// Where block (row, column) of the Hessian is kept, column <= row < 3.
  static constexpr std::size_t block(std::size_t row, std::size_t column) {
    return row * (row + 1) / 2 + column;
  }
  static constexpr std::size_t kBlocks = 6;

  std::array<Eigen::Matrix2d, kBlocks> H;
  std::array<Vector2d, 3> g;
};

/// The system of a Newton step of a triangulation whose vertices have two coordinates each: sums
/// of the models of its faces. Its sparsity is found once.
class NewtonSystem {
 public:
  /// `unknown` per vertex: the number of its first coordinate, even and counted from 0 without a
  /// gap over the vertices that move; -1 where a vertex is fixed.
  NewtonSystem(const MatrixX3i& F, std::vector<int> unknown);
  ~NewtonSystem();
  NewtonSystem(const NewtonSystem&) = delete;
  NewtonSystem& operator=(const NewtonSystem&) = delete;

  /// The sum of the faces' models, which are given in their order.
  void assemble(const std::vector<FaceSystem>& faces);
  /// Adds a model of one vertex that moves.
  void add(int vertex, const Eigen::Matrix2d& H, const Vector2d& g);

  /// The step that minimises the model plus damping / 2 times the step's square; false where the
  /// matrix is not positive definite in doubles and where nothing moves.
  bool solve(double damping, Eigen::VectorXd& step);

  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// Mean of the Hessian's diagonal entries.
  [[nodiscard]] double mean_diagonal() const;
  [[nodiscard]] int unknown(int vertex) const { return unknown_[static_cast<std::size_t>(vertex)]; }

 private:
  /// Where the two columns of a 2 x 2 block begin among the values of H_; -1 where there is none.
  /// On the diagonal the second begins above the entry that is kept.
  using Place = std::array<Eigen::Index, 2>;

  void add_block(const Place& place, bool is_diagonal, const Eigen::Matrix2d& H);
  [[nodiscard]] Eigen::Index diagonal(int i) const { return H_.outerIndexPtr()[i]; }

  MatrixX3i F_;
  std::vector<int> unknown_;
  std::vector<std::array<Place, FaceSystem::kBlocks>> places_;  ///< per face
  SparseMatrix H_;                                              ///< lower triangle
  Eigen::VectorXd gradient_;
  class Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace crosspatch
