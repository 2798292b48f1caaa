#include "param/newton_system.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>
#include <algorithm>

#include "core/blas.hpp"
#include "core/index.hpp"

namespace crosspatch {

using std::size_t;

/// Solves systems of one sparsity pattern, whose lower triangle is given, with positive definite
/// matrices: Eigen's simplicial factor for small ones, CHOLMOD's supernodal one for large ones,
/// where it takes a fraction of the time.
class NewtonSystem::Solver {
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

  SingleThreadedBlas one_thread_;
  /// Unknowns. Coarse levels have 3200 and gain by supernodes; below nothing was measured.
  static constexpr Eigen::Index kLarge = 2000;
  bool is_large_ = false;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> simplicial_;
  Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> supernodal_;
};

NewtonSystem::NewtonSystem(const MatrixX3i& F, std::vector<int> unknown)
    : F_(F),
      unknown_(std::move(unknown)),
      places_(idx(static_cast<int>(F.rows()))),
      solver_(std::make_unique<Solver>()) {
  // Calls visit(face, a, b, row, column) for every block on or below the diagonal.
  const auto for_each_block = [&](const auto& visit) {
    for (int f = 0; f < F_.rows(); ++f)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b <= a; ++b) {
          const int u = unknown_[idx(F_(f, a))], v = unknown_[idx(F_(f, b))];
          if (u >= 0 && v >= 0) visit(f, a, b, std::max(u, v), std::min(u, v));
        }
  };
  std::vector<Eigen::Triplet<double>> entries;
  for_each_block([&](int, int, int, int i, int j) {
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q < 2; ++q)
        if (i + p >= j + q) entries.emplace_back(i + p, j + q, 0.0);
  });
  const auto last = std::max_element(unknown_.begin(), unknown_.end());
  const int n = last == unknown_.end() || *last < 0 ? 0 : *last + 2;
  H_.resize(n, n);
  H_.setFromTriplets(entries.begin(), entries.end());
  H_.makeCompressed();
  gradient_.setZero(H_.rows());
  solver_->analyze(H_);
  for (auto& places : places_) places.fill({-1, -1});
  const auto place = [&](int row, int column) {
    const int *begin = H_.innerIndexPtr() + H_.outerIndexPtr()[column],
              *end = H_.innerIndexPtr() + H_.outerIndexPtr()[column + 1];
    return std::lower_bound(begin, end, row) - H_.innerIndexPtr();
  };
  for_each_block([&](int f, int a, int b, int i, int j) {
    // The two entries of a column are neighbours in it.
    places_[idx(f)][FaceSystem::block(idx(a), idx(b))] = {
        place(i, j), i == j ? diagonal(j + 1) - 1 : place(i, j + 1)};
  });
}

NewtonSystem::~NewtonSystem() = default;

void NewtonSystem::assemble(const std::vector<FaceSystem>& faces) {
  std::fill(H_.valuePtr(), H_.valuePtr() + H_.nonZeros(), 0.0);
  gradient_.setZero();
  for (int f = 0; f < F_.rows(); ++f) {
    const FaceSystem& face = faces[idx(f)];
    for (int a = 0; a < 3; ++a) {
      const int i = unknown_[idx(F_(f, a))];
      if (i < 0) continue;
      gradient_.segment<2>(i) += face.g[idx(a)];
      for (int b = 0; b <= a; ++b) {
        const size_t k = FaceSystem::block(idx(a), idx(b));
        const int j = unknown_[idx(F_(f, b))];
        if (j < 0) continue;
        if (i >= j)
          add_block(places_[idx(f)][k], i == j, face.H[k]);
        else
          add_block(places_[idx(f)][k], false, face.H[k].transpose());
      }
    }
  }
}

void NewtonSystem::add(int vertex, const Eigen::Matrix2d& H, const Vector2d& g) {
  const int i = unknown(vertex);
  gradient_.segment<2>(i) += g;
  add_block({diagonal(i), diagonal(i + 1) - 1}, true, H);
}

void NewtonSystem::add_block(const Place& place, bool is_diagonal, const Eigen::Matrix2d& H) {
  double* values = H_.valuePtr();
  values[place[0]] += H(0, 0);
  values[place[0] + 1] += H(1, 0);
  if (!is_diagonal) values[place[1]] += H(0, 1);
  values[place[1] + 1] += H(1, 1);
}

bool NewtonSystem::solve(double damping, Eigen::VectorXd& step) {
  if (H_.cols() == 0) return false;
  for (int i = 0; i < H_.cols(); ++i) H_.valuePtr()[diagonal(i)] += damping;
  return solver_->solve(H_, -gradient_, step);
}

double NewtonSystem::mean_diagonal() const {
  double sum = 0;
  for (int i = 0; i < H_.cols(); ++i) sum += H_.valuePtr()[diagonal(i)];
  return sum / static_cast<double>(std::max<Eigen::Index>(H_.cols(), 1));
}

}  // namespace crosspatch
