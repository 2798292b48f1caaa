// Notation: J (3 x 2) takes a face's rest shape, scaled to the area it is expected to have on the
// sphere, to its chord triangle; d is its signed area over the expected one. The energy
//   (|J|^2 + 1 + d^2) / chi(d),  chi(d) = (d + sqrt(epsilon^2 + d^2)) / 2,
// is finite for turned faces and becomes a barrier as epsilon falls to zero. It is a sum of squares
// of residuals.
#include "param/unfold.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "param/sphere_orientation.hpp"
#include "param/untangle.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Matrix32 = Eigen::Matrix<double, 3, 2>;
using Residuals = Eigen::Matrix<double, 8, 1>;
using Matrix86 = Eigen::Matrix<double, 8, 6>;

size_t at(int i) {
  return static_cast<size_t>(i);
}

class Unfolder {
 public:
  Unfolder(const SphereProblem& problem, MatrixX3d& X) : problem_(problem), X_(X) {
    unknown_.assign(at(static_cast<int>(X.rows())), -1);
    for (const int v : problem.F.reshaped())
      if (unknown_[at(v)] < 0 && !problem.fixed[at(v)]) {
        unknown_[at(v)] = 2 * static_cast<int>(free_.size());
        free_.push_back(v);
      }
  }

  int run() {
    constexpr int kMostIterations = 200;
    epsilon_ = 1;
    lower_epsilon(1);
    for (int i = 0; i < kMostIterations && turned_faces(problem_.F, X_) > 0; ++i) {
      const double before = energy(X_);
      const double after = step(before);
      if (!(after < before)) break;
      lower_epsilon(after / before);
    }
    return turned_faces(problem_.F, X_);
  }

 private:
  [[nodiscard]] double area_ratio(const MatrixX3d& X, int f) const {
    const Vector3d x = X.row(problem_.F(f, 0)), y = X.row(problem_.F(f, 1)),
                   z = X.row(problem_.F(f, 2));
    return x.dot((y - x).cross(z - x)) / problem_.reference_orientation[f];
  }

  [[nodiscard]] double chi(double d) const { return (d + std::hypot(epsilon_, d)) / 2; }

  /// Their Eq. (4): the barrier follows the worst face.
  void lower_epsilon(double energy_ratio) {
    double worst = std::numeric_limits<double>::infinity();
    for (int f = 0; f < problem_.F.rows(); ++f) worst = std::min(worst, area_ratio(X_, f));
    const double sigma = std::max(1 - energy_ratio, 0.1), mu = (1 - sigma) * chi(worst);
    constexpr double kLeast = 1e-10;
    epsilon_ = worst < mu ? 2 * std::sqrt(mu * (mu - worst)) : kLeast;
  }

  [[nodiscard]] Residuals residuals(const MatrixX3d& X, int f, Matrix86* derivative) const {
    const Vector3d x[3] = {
        X.row(problem_.F(f, 0)), X.row(problem_.F(f, 1)), X.row(problem_.F(f, 2))};
    const double scale = std::sqrt(2 * problem_.rest_area[f] / problem_.reference_orientation[f]);
    const Eigen::Matrix2d S = scale * problem_.rest_inverse[at(f)];
    Matrix32 E;
    E << x[1] - x[0], x[2] - x[0];
    const Matrix32 J = E * S;
    const double d = area_ratio(X, f), h = std::hypot(epsilon_, d), c = chi(d);
    Residuals r;
    r << J.col(0), J.col(1), 1, d;
    if (derivative != nullptr) {
      const double dc = (1 + d / h) / 2;
      for (int k = 0; k < 3; ++k) {
        const int v = problem_.F(f, k);
        const Matrix32 B = basis(X.row(v).transpose());
        const Eigen::RowVector2d s =
            k == 0 ? Eigen::RowVector2d(-S.colwise().sum()) : Eigen::RowVector2d(S.row(k - 1));
        const Vector3d normal =
            x[(k + 1) % 3].cross(x[(k + 2) % 3]) / problem_.reference_orientation[f];
        for (int j = 0; j < 2; ++j) {
          const double dd = normal.dot(B.col(j));
          Residuals dr;
          dr << s[0] * B.col(j), s[1] * B.col(j), 0, dd;
          derivative->col(2 * k + j) = dr / std::sqrt(c) - r * (dc * dd / (2 * c * std::sqrt(c)));
        }
      }
    }
    return r / std::sqrt(c);
  }

  static Matrix32 basis(const Vector3d& x) {
    Matrix32 B;
    B.col(0) = x.unitOrthogonal();
    B.col(1) = x.cross(B.col(0));
    return B;
  }

  [[nodiscard]] double energy(const MatrixX3d& X) const {
    double sum = 0;
    for (int f = 0; f < problem_.F.rows(); ++f) sum += residuals(X, f, nullptr).squaredNorm();
    return sum;
  }

  /// One Gauss-Newton step with backtracking; the new energy, or `before` if no step is lower.
  double step(double before) {
    const int n = 2 * static_cast<int>(free_.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    double trace = 0;
    for (int f = 0; f < problem_.F.rows(); ++f) {
      Matrix86 D = Matrix86::Zero();
      const Residuals r = residuals(X_, f, &D);
      const Eigen::Matrix<double, 6, 6> H = D.transpose() * D;
      const Eigen::Matrix<double, 6, 1> g = D.transpose() * r;
      for (int a = 0; a < 6; ++a) {
        const int i = unknown_[at(problem_.F(f, a / 2))];
        if (i < 0) continue;
        gradient[i + a % 2] += g[a];
        trace += H(a, a);
        for (int b = 0; b < 6; ++b)
          if (const int j = unknown_[at(problem_.F(f, b / 2))]; j >= 0 && i + a % 2 >= j + b % 2)
            entries.emplace_back(i + a % 2, j + b % 2, H(a, b));
      }
    }
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1e-9 * trace / n);
    SparseMatrix H(n, n);
    H.setFromTriplets(entries.begin(), entries.end());
    if (!analyzed_) solver_.analyzePattern(H);
    analyzed_ = true;
    solver_.factorize(H);
    if (solver_.info() != Eigen::Success) return before;
    const Eigen::VectorXd direction = solver_.solve(-gradient);
    constexpr int kHalvings = 20;
    double t = 1;
    for (int i = 0; i < kHalvings; ++i, t /= 2) {
      MatrixX3d X = X_;
      for (const int v : free_)
        X.row(v) = (X_.row(v).transpose() +
                    t * basis(X_.row(v).transpose()) * direction.segment<2>(unknown_[at(v)]))
                       .normalized()
                       .transpose();
      const double e = energy(X);
      if (!(e < before)) continue;
      X_ = X;
      return e;
    }
    return before;
  }

  const SphereProblem& problem_;
  MatrixX3d& X_;
  std::vector<int> unknown_;  ///< per vertex: its first coordinate's unknown, or -1
  std::vector<int> free_;
  double epsilon_ = 1;
  bool analyzed_ = false;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> solver_;
};

}  // namespace

int unfold(const SphereProblem& problem, MatrixX3d& X) {
  return Unfolder(problem, X).run();
}

}  // namespace crosspatch
