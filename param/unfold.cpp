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
    for (int f = 0; f < problem.F.rows(); ++f)
      if (unknown_[at(problem.F(f, 0))] >= 0 || unknown_[at(problem.F(f, 1))] >= 0 ||
          unknown_[at(problem.F(f, 2))] >= 0)
        faces_.push_back(f);
    F_ = problem.F(faces_, Eigen::all);
    covered_ = covered_area(F_, X);
  }

  int run() {
    constexpr int kMostIterations = 60;
    epsilon_ = 1;
    lower_epsilon(1);
    for (int i = 0; i < kMostIterations && turned_faces(F_, X_) > 0; ++i) {
      const double before = energy(X_);
      const double after = step(before);
      if (!(after < before)) break;
      lower_epsilon(after / before);
    }
    return turned_faces(F_, X_);
  }

  /// Improves shapes where no face is turned: the energy is a barrier then.
  void smooth() {
    constexpr int kMostIterations = 20;
    epsilon_ = 0;
    double before = energy(X_);
    for (int i = 0; i < kMostIterations; ++i) {
      const double after = step(before);
      constexpr double kWorthwhile = 1e-2;
      if (!(after < (1 - kWorthwhile) * before)) break;
      before = after;
    }
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
    for (const int f : faces_) worst = std::min(worst, area_ratio(X_, f));
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
    for (const int f : faces_) sum += residuals(X, f, nullptr).squaredNorm();
    return sum;
  }

  /// One Gauss-Newton step with backtracking; the new energy, or `before` if no step is lower.
  double step(double before) {
    const int n = 2 * static_cast<int>(free_.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    double trace = 0;
    for (const int f : faces_) {
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
      // A long step may drag a face around the back of the sphere.
      const double e = energy(X);
      if (!(e > 0 && e < before) || std::abs(covered_area(F_, X) - covered_) > 1) continue;
      X_ = X;
      return e;
    }
    return before;
  }

  const SphereProblem& problem_;
  MatrixX3d& X_;
  std::vector<int> unknown_;  ///< per vertex: its first coordinate's unknown, or -1
  std::vector<int> free_;
  std::vector<int> faces_;  ///< that can move
  MatrixX3i F_;             ///< their corners
  double covered_ = 0;      ///< area they cover on the sphere, signed; steps by 4 pi only
  double epsilon_ = 1;
  bool analyzed_ = false;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> solver_;
};

bool turned(const MatrixX3i& F, const MatrixX3d& X, int f) {
  return !(sphere_orientation(X.row(F(f, 0)).transpose(),
                              X.row(F(f, 1)).transpose(),
                              X.row(F(f, 2)).transpose()) > 0);
}

/// Fixes the vertices more than `rings` edges away from turned faces.
void hold_far_vertices(const MatrixX3d& X, int rings, SphereProblem& problem) {
  std::vector<bool> near(problem.fixed.size(), false);
  for (int f = 0; f < problem.F.rows(); ++f)
    if (turned(problem.F, X, f))
      for (int k = 0; k < 3; ++k) near[at(problem.F(f, k))] = true;
  for (int i = 0; i < rings; ++i) {
    std::vector<bool> grown = near;
    for (int f = 0; f < problem.F.rows(); ++f)
      if (near[at(problem.F(f, 0))] || near[at(problem.F(f, 1))] || near[at(problem.F(f, 2))])
        for (int k = 0; k < 3; ++k) grown[at(problem.F(f, k))] = true;
    near = std::move(grown);
  }
  for (const int v : problem.F.reshaped())
    if (!near[at(v)]) problem.fixed[at(v)] = true;
}

}  // namespace

int unfold(const SphereProblem& problem, MatrixX3d& X) {
  constexpr int kMostRings = 8;
  int left = turned_faces(problem.F, X);
  MatrixX3d best = X;
  for (int rings = 2; left > 0 && rings <= kMostRings; rings *= 2) {
    SphereProblem near = problem;
    hold_far_vertices(X, rings, near);
    MatrixX3d moved = X;
    Unfolder unfolder(near, moved);
    if (unfolder.run() == 0) unfolder.smooth();
    const int turned = turned_faces(problem.F, moved);
    if (turned < left) {
      left = turned;
      best = moved;
    }
  }
  X = best;
  return left;
}

void smooth_on_sphere(const SphereProblem& problem, MatrixX3d& X) {
  Unfolder(problem, X).smooth();
}

}  // namespace crosspatch
