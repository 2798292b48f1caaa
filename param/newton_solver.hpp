#pragma once

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>

#include "core/types.hpp"

namespace crosspatch {

/// Solves systems of one sparsity pattern, whose lower triangle is given, with positive definite
/// matrices: Eigen's simplicial factor for small ones, CHOLMOD's supernodal one for large ones,
/// where it takes a fraction of the time. The BLAS has to run on one thread meanwhile; see
/// SingleThreadedBlas.
class NewtonSolver {
 public:
  void analyze(const SparseMatrix& H) {
    is_large_ = H.rows() > kLarge;
    if (is_large_) {
      supernodal_.cholmod().print = 0;
      supernodal_.analyzePattern(H);
    } else {
      simplicial_.analyzePattern(H);
    }
  }
  /// False where the matrix is not positive definite in doubles or the solution is not finite.
  bool solve(const SparseMatrix& H, const Eigen::VectorXd& rhs, Eigen::VectorXd& x) {
    return (is_large_ ? solve_by(supernodal_, H, rhs, x) : solve_by(simplicial_, H, rhs, x)) &&
           x.allFinite();
  }

 private:
  template <class Factor>
  static bool solve_by(Factor& factor,
                       const SparseMatrix& H,
                       const Eigen::VectorXd& rhs,
                       Eigen::VectorXd& x) {
    factor.factorize(H);
    if (factor.info() != Eigen::Success) return false;
    x = factor.solve(rhs);
    return true;
  }

  static constexpr Eigen::Index kLarge = 20000;  // unknowns
  bool is_large_ = false;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> simplicial_;
  Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> supernodal_;
};

}  // namespace crosspatch
