// Notation: J (3 x 2) takes a face's rest shape, scaled to the area it is expected to have on the
// sphere, to its chord triangle; d is its signed area over the expected one. The energy
//   (|J|^2 + 1 + d^2) / chi(d),  chi(d) = (d + sqrt(epsilon^2 + d^2)) / 2,
// is finite for turned faces and becomes a barrier as epsilon falls to zero. It is a sum of squares
// of residuals.
#include "param/unfold.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/union_find.hpp"
#include "param/newton_system.hpp"
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
  /// `faces` are all that have a vertex among the `movable` ones.
  Unfolder(const SphereProblem& problem,
           std::vector<int> movable,
           std::vector<int> faces,
           MatrixX3d& X)
      : problem_(problem), X_(X), free_(std::move(movable)), faces_(std::move(faces)) {
    F_ = problem.F(faces_, Eigen::all);
    covered_ = covered_area(F_, X);
    std::vector<int> unknown(problem.fixed.size(), -1);
    for (size_t i = 0; i < free_.size(); ++i) unknown[at(free_[i])] = 2 * static_cast<int>(i);
    system_.emplace(F_, std::move(unknown));
  }

  /// Returns the number of faces that are left turned.
  int run() {
    constexpr int kMostIterations = 60;
    epsilon_ = 1;
    lower_epsilon(1);
    int left = turned_faces(F_, X_);
    double before = energy(X_);
    for (int i = 0; i < kMostIterations && left > 0; ++i) {
      const double after = step(before);
      if (!(after < before)) break;
      lower_epsilon(after / before);
      before = energy(X_);
      left = turned_faces(F_, X_);
    }
    return left;
  }

  [[nodiscard]] int turned() const { return turned_faces(F_, X_); }

  void move_back(const MatrixX3d& X) {
    for (const int v : free_) X_.row(v) = X.row(v);
  }

  /// Improves shapes where no face is turned: the energy is a barrier then.
  void smooth() {
    constexpr int kMostIterations = 20;
    epsilon_ = 0;
    double before = energy(X_);
    for (int i = 0; i < kMostIterations; ++i) {
      const double after = step(before);
      constexpr double kWorthwhile = 5e-2;
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
    Eigen::VectorXd energies(static_cast<Eigen::Index>(faces_.size()));
    tbb::parallel_for(tbb::blocked_range<int>(0, static_cast<int>(faces_.size()), kGrain),
                      [&](const tbb::blocked_range<int>& range) {
                        for (int i = range.begin(); i < range.end(); ++i)
                          energies[i] = residuals(X, faces_[at(i)], nullptr).squaredNorm();
                      });
    return energies.sum();
  }

  [[nodiscard]] FaceSystem face_system(int f) const {
    Matrix86 D = Matrix86::Zero();
    const Residuals r = residuals(X_, f, &D);
    FaceSystem s;
    for (int a = 0; a < 3; ++a) {
      s.g[at(a)] = D.middleCols<2>(2 * a).transpose() * r;
      for (int b = 0; b <= a; ++b)
        s.H[FaceSystem::block(at(a), at(b))] =
            D.middleCols<2>(2 * a).transpose() * D.middleCols<2>(2 * b);
    }
    return s;
  }

  /// One Gauss-Newton step with backtracking; the new energy, or `before` if no step is lower.
  double step(double before) {
    std::vector<FaceSystem> systems(faces_.size());
    tbb::parallel_for(tbb::blocked_range<int>(0, static_cast<int>(faces_.size()), kGrain),
                      [&](const tbb::blocked_range<int>& range) {
                        for (int i = range.begin(); i < range.end(); ++i)
                          systems[at(i)] = face_system(faces_[at(i)]);
                      });
    system_->assemble(systems);
    constexpr double kDamping = 1e-9;
    Eigen::VectorXd direction;
    if (!system_->solve(kDamping * system_->mean_diagonal(), direction)) return before;
    const MatrixX3d start = X_(free_, Eigen::all);
    constexpr int kHalvings = 20;
    double t = 1;
    for (int i = 0; i < kHalvings; ++i, t /= 2) {
      for (size_t k = 0; k < free_.size(); ++k) {
        const Vector3d x = start.row(static_cast<Eigen::Index>(k)).transpose();
        const Vector2d d = direction.segment<2>(2 * static_cast<Eigen::Index>(k));
        X_.row(free_[k]) = (x + t * basis(x) * d).normalized().transpose();
      }
      // A long step may drag a face around the back of the sphere.
      const double e = energy(X_);
      if (e > 0 && e < before && std::abs(covered_area(F_, X_) - covered_) <= 1) return e;
    }
    X_(free_, Eigen::all) = start;
    return before;
  }

  static constexpr int kGrain = 64;

  const SphereProblem& problem_;
  MatrixX3d& X_;
  std::vector<int> free_;   ///< vertices; vertex i has unknowns 2 i and 2 i + 1
  std::vector<int> faces_;  ///< that can move
  MatrixX3i F_;             ///< their corners
  double covered_ = 0;      ///< area they cover on the sphere, signed; steps by 4 pi only
  double epsilon_ = 1;
  std::optional<NewtonSystem> system_;
};

bool turned(const MatrixX3i& F, const MatrixX3d& X, int f) {
  return !(sphere_orientation(X.row(F(f, 0)).transpose(),
                              X.row(F(f, 1)).transpose(),
                              X.row(F(f, 2)).transpose()) > 0);
}

/// Free vertices that hang together by faces, and all faces around them.
struct Island {
  std::vector<int> vertices, faces;
};

/// The connected parts of what lies within `rings` edges of turned faces.
std::vector<Island> islands(const SphereProblem& problem, const MatrixX3d& X, int rings) {
  const MatrixX3i& F = problem.F;
  const auto has = [&](const std::vector<bool>& set, int f) {
    return set[at(F(f, 0))] || set[at(F(f, 1))] || set[at(F(f, 2))];
  };
  std::vector<bool> near(problem.fixed.size(), false);
  for (int f = 0; f < F.rows(); ++f)
    if (turned(F, X, f))
      for (int k = 0; k < 3; ++k) near[at(F(f, k))] = true;
  for (int i = 0; i < rings; ++i) {
    std::vector<bool> grown = near;
    for (int f = 0; f < F.rows(); ++f)
      if (has(near, f))
        for (int k = 0; k < 3; ++k) grown[at(F(f, k))] = true;
    near = std::move(grown);
  }
  for (size_t v = 0; v < near.size(); ++v) near[v] = near[v] && !problem.fixed[v];
  UnionFind parts(static_cast<int>(near.size()));
  for (int f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      if (const int a = F(f, k), b = F(f, (k + 1) % 3); near[at(a)] && near[at(b)])
        parts.join(a, b);
  std::vector<Island> found;
  std::vector<int> number(near.size(), -1), seen(near.size(), 0);
  const auto island = [&](int v) -> Island& {
    int& i = number[at(parts.find(v))];
    if (i < 0) {
      i = static_cast<int>(found.size());
      found.emplace_back();
    }
    return found[at(i)];
  };
  for (int f = 0; f < F.rows(); ++f) {
    if (!has(near, f)) continue;
    for (int k = 0; k < 3; ++k)
      if (const int v = F(f, k); near[at(v)] && seen[at(v)]++ == 0) island(v).vertices.push_back(v);
    for (int k = 0; k < 3; ++k)
      if (const int v = F(f, k); near[at(v)]) {
        island(v).faces.push_back(f);
        break;
      }
  }
  return found;
}

}  // namespace

int unfold(const SphereProblem& problem, MatrixX3d& X) {
  constexpr int kMostRings = 8;
  for (int rings = 2; rings <= kMostRings && turned_faces(problem.F, X) > 0; rings *= 2) {
    const MatrixX3d before = X;
    const std::vector<Island> parts = islands(problem, X, rings);
    tbb::parallel_for(size_t{0}, parts.size(), [&](size_t i) {
      Unfolder unfolder(problem, parts[i].vertices, parts[i].faces, X);
      const int turned = unfolder.turned(), left = unfolder.run();
      if (left == 0)
        unfolder.smooth();
      else if (rings < kMostRings || left >= turned)
        unfolder.move_back(before);
    });
  }
  return turned_faces(problem.F, X);
}

void smooth_on_sphere(const SphereProblem& problem, MatrixX3d& X) {
  Island all;
  std::vector<bool> seen = problem.fixed;
  for (int f = 0; f < problem.F.rows(); ++f) {
    bool moves = false;
    for (int k = 0; k < 3; ++k) {
      const int v = problem.F(f, k);
      moves = moves || !problem.fixed[at(v)];
      if (seen[at(v)]) continue;
      seen[at(v)] = true;
      all.vertices.push_back(v);
    }
    if (moves) all.faces.push_back(f);
  }
  Unfolder(problem, std::move(all.vertices), std::move(all.faces), X).smooth();
}

}  // namespace crosspatch
