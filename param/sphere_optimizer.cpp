// Projected Newton steps for symmetric Dirichlet energies of triangulations that move on the sphere
// and are judged after a lift.
//
// Notation: a vertex x moves by x + B t with B (3 x 2) an orthonormal basis of its tangent plane;
// its lifted point moves by L B t with L the lift's derivative. In the plane of a lifted face (axes
// P, 2 x 3) the Jacobian from the rest face is J = P [y1 - y0, y2 - y0] D, D the inverse rest
// edges.
#include "param/sphere_optimizer.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "param/sphere_orientation.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Matrix32 = Eigen::Matrix<double, 3, 2>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

size_t at(int i) {
  return static_cast<size_t>(i);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Matrix32 tangent_basis(const Vector3d& x) {
  const Vector3d axis = std::abs(x[0]) < 0.6 ? Vector3d::UnitX() : Vector3d::UnitY();
  Matrix32 b;
  b.col(0) = x.cross(axis).normalized();
  b.col(1) = x.cross(b.col(0));
  return b;
}

/// Hessian and gradient of one face in the six tangent coordinates of its corners.
struct FaceSystem {
  Matrix6 H;
  Vector6 g;
};

class Optimizer {
 public:
  Optimizer(const SphereProblem& problem,
            const Lift& lift,
            const SphereOptimizerOptions& options,
            MatrixX3d& X,
            std::vector<int>& hint)
      : problem_(problem), lift_(lift), options_(options), X_(X), hint_(hint) {
    Y_.resize(X.rows(), 3);
    reference_ = problem.reference_orientation;
    total_area_ = problem.rest_area.sum();
    build_pattern();
  }

  SphereOptimizerReport run() {
    SphereOptimizerReport report;
    if (options_.distortion == Distortion::kNearlyConformal) refer_to_chords();
    double energy = evaluate(X_, hint_, Y_);
    report.energy_before = energy;
    // Common steps move whole limbs; where kinks of the lift or squeezed faces stop them, single
    // vertices still get on.
    int failures = 0;
    constexpr int kMostFailures = 2, kSweeps = 3;
    for (; report.iterations < options_.max_iterations; ++report.iterations) {
      if (options_.distortion == Distortion::kNearlyConformal) {
        refer_to_chords();
        energy = evaluate(X_, hint_, Y_);
      }
      const double before = energy;
      if (failures < kMostFailures) {
        assemble();
        const double lower = solve() ? line_search(energy) : energy;
        failures = lower < energy ? 0 : failures + 1;
      }
      for (int i = 0; i < kSweeps; ++i) sweep();
      energy = evaluate(X_, hint_, Y_);
      if (before - energy < options_.relative_decrease * std::abs(before)) {
        ++report.iterations;
        break;
      }
    }
    report.energy_after = energy;
    return report;
  }

 private:
  Vector3d corner(const MatrixX3d& M, int f, int k) const {
    return M.row(problem_.F(f, k)).transpose();
  }

  void refer_to_chords() {
    for (int f = 0; f < problem_.F.rows(); ++f) {
      const Vector3d x = corner(X_, f, 0);
      reference_[f] = (corner(X_, f, 1) - x).cross(corner(X_, f, 2) - x).norm();
    }
  }

  /// Mean energy per area; infinite if a face is turned over on the sphere. Updates hints and
  /// lifted points.
  double evaluate(const MatrixX3d& X, std::vector<int>& hint, MatrixX3d& Y) const {
    const int faces = static_cast<int>(problem_.F.rows());
    for (int f = 0; f < faces; ++f)
      if (!(sphere_orientation(corner(X, f, 0), corner(X, f, 1), corner(X, f, 2)) > 0))
        return kInfinity;
    tbb::parallel_for(0, static_cast<int>(X.rows()), [&](int v) {
      if (active_[at(v)]) Y.row(v) = lift_.point(X.row(v).transpose(), hint[at(v)]).transpose();
    });
    Eigen::VectorXd energy(faces);
    tbb::parallel_for(0, faces, [&](int f) {
      energy[f] = face_energy(f,
                              {corner(X, f, 0), corner(X, f, 1), corner(X, f, 2)},
                              {corner(Y, f, 0), corner(Y, f, 1), corner(Y, f, 2)});
    });
    return energy.sum() / total_area_;
  }

  /// Energy of one face, weighted, with its corners at x on the sphere and y on the surface.
  [[nodiscard]] double face_energy(int f,
                                   const std::array<Vector3d, 3>& x,
                                   const std::array<Vector3d, 3>& y) const {
    const double det = sphere_orientation(x[0], x[1], x[2]);
    if (!(det > 0)) return kInfinity;
    const double e =
        distortion(options_.distortion, problem_.rest_inverse[at(f)], y[0], y[1], y[2]);
    return problem_.rest_area[f] * (e + options_.barrier * reference_[f] / det);
  }

  /// One Newton step with a line search for each free vertex in turn, the others held.
  void sweep() {
    for (int v = 0; v < X_.rows(); ++v)
      if (unknown_[at(v)] >= 0) step_alone(v);
  }

  void step_alone(int v) {
    const Vector3d x = X_.row(v).transpose();
    const Matrix32 basis = tangent_basis(x);
    basis_[at(v)] = basis;
    tangent_[at(v)] = lift_.derivative(x, hint_[at(v)]) * basis;
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    Vector2d g = Vector2d::Zero();
    for (int f : faces_of(v)) {
      const int k = corner_of(f, v);
      const FaceSystem s = face_system(f, 1 << k);
      H += s.H.block<2, 2>(2 * k, 2 * k);
      g += s.g.segment<2>(2 * k);
    }
    const Vector2d step = -H.ldlt().solve(g);
    if (!step.allFinite()) return;
    const double energy = star_energy(v, x, Y_.row(v).transpose());
    constexpr int kHalvings = 5;
    double t = 1;
    for (int i = 0; i < kHalvings; ++i, t /= 2) {
      const Vector3d moved = (x + t * basis * step).normalized();
      int face = hint_[at(v)];
      const Vector3d y = lift_.point(moved, face);
      if (!(star_energy(v, moved, y) < energy)) continue;
      X_.row(v) = moved.transpose();
      Y_.row(v) = y.transpose();
      hint_[at(v)] = face;
      return;
    }
  }

  [[nodiscard]] double star_energy(int v, const Vector3d& x, const Vector3d& y) const {
    double sum = 0;
    for (int f : faces_of(v)) {
      std::array<Vector3d, 3> xs, ys;
      for (int k = 0; k < 3; ++k) {
        const bool here = problem_.F(f, k) == v;
        xs[at(k)] = here ? x : corner(X_, f, k);
        ys[at(k)] = here ? y : corner(Y_, f, k);
      }
      sum += face_energy(f, xs, ys);
    }
    return sum;
  }

  [[nodiscard]] std::span<const int> faces_of(int v) const {
    return {faces_.data() + faces_begin_[at(v)], faces_.data() + faces_begin_[at(v) + 1]};
  }

  [[nodiscard]] int corner_of(int f, int v) const {
    return problem_.F(f, 0) == v ? 0 : problem_.F(f, 1) == v ? 1 : 2;
  }

  /// `corners`: bits of the corners whose rows are wanted.
  FaceSystem face_system(int f, int corners = 7) const {
    const Vector3d y0 = corner(Y_, f, 0), u = corner(Y_, f, 1) - y0, v = corner(Y_, f, 2) - y0;
    const Vector3d normal = u.cross(v).normalized();
    Eigen::Matrix<double, 2, 3> P;
    P.row(0) = u.normalized().transpose();
    P.row(1) = normal.cross(P.row(0).transpose()).transpose();
    Eigen::Matrix2d E;
    E << P * u, P * v;
    const Eigen::Matrix2d& D = problem_.rest_inverse[at(f)];
    const Eigen::Matrix2d J = E * D;
    Eigen::Matrix<double, 4, 6> G = Eigen::Matrix<double, 4, 6>::Zero();
    for (int k = 0; k < 3; ++k) {
      if ((corners >> k & 1) == 0) continue;
      const Eigen::Matrix2d M = P * tangent_[at(problem_.F(f, k))];
      // How the edge matrix E follows corner k.
      const Eigen::RowVector2d s = k == 0   ? Eigen::RowVector2d(-1, -1)
                                   : k == 1 ? Eigen::RowVector2d(1, 0)
                                            : Eigen::RowVector2d(0, 1);
      const Eigen::RowVector2d sd = s * D;
      for (int j = 0; j < 2; ++j) G.col(2 * k + j) = vec(M.col(j) * sd);
    }
    const IsotropicHessian e = isotropic_hessian(J, options_.distortion);
    const double weight = problem_.rest_area[f] / total_area_;
    FaceSystem s{weight * G.transpose() * e.H * G, weight * G.transpose() * e.g};
    add_barrier(f, s);
    return s;
  }

  /// Barrier b = det0 / det as the square of the residual sqrt(b).
  void add_barrier(int f, FaceSystem& s) const {
    const Vector3d x[3] = {corner(X_, f, 0), corner(X_, f, 1), corner(X_, f, 2)};
    const double det = sphere_orientation(x[0], x[1], x[2]);
    const double b = problem_.rest_area[f] / total_area_ * options_.barrier * reference_[f] / det;
    Vector6 ddet;
    for (int k = 0; k < 3; ++k)
      ddet.segment<2>(2 * k) =
          basis_[at(problem_.F(f, k))].transpose() * x[(k + 1) % 3].cross(x[(k + 2) % 3]);
    const Vector6 dr = -0.5 * std::sqrt(b) / det * ddet;
    s.H += 2 * dr * dr.transpose();
    s.g += 2 * std::sqrt(b) * dr;
  }

  /// Unknowns are numbered over the free vertices; the lower triangle's sparsity is fixed by the
  /// faces.
  void build_pattern() {
    const int vertices = static_cast<int>(X_.rows());
    active_.assign(at(vertices), false);
    for (int f = 0; f < problem_.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) active_[at(problem_.F(f, k))] = true;
    faces_begin_.assign(at(vertices) + 1, 0);
    for (int v : problem_.F.reshaped()) ++faces_begin_[at(v) + 1];
    std::partial_sum(faces_begin_.begin(), faces_begin_.end(), faces_begin_.begin());
    faces_.resize(at(3 * static_cast<int>(problem_.F.rows())));
    std::vector<int> fill(faces_begin_.begin(), faces_begin_.end() - 1);
    for (int f = 0; f < problem_.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) faces_[at(fill[at(problem_.F(f, k))]++)] = f;
    unknown_.assign(at(vertices), -1);
    int n = 0;
    for (int v = 0; v < vertices; ++v)
      if (active_[at(v)] && !problem_.fixed[at(v)]) unknown_[at(v)] = 2 * n++;
    std::vector<Eigen::Triplet<double>> entries;
    for (int f = 0; f < problem_.F.rows(); ++f)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          const int i = unknown_[at(problem_.F(f, a))], j = unknown_[at(problem_.F(f, b))];
          if (i < 0 || j < 0 || i < j) continue;
          for (int p = 0; p < 2; ++p)
            for (int q = 0; q < 2; ++q)
              if (i + p >= j + q) entries.emplace_back(i + p, j + q, 0.0);
        }
    H_.resize(2 * n, 2 * n);
    H_.setFromTriplets(entries.begin(), entries.end());
    H_.makeCompressed();
    solver_.analyzePattern(H_);
    gradient_.resize(2 * n);
    basis_.resize(at(vertices));
    tangent_.resize(at(vertices));
    systems_.resize(at(static_cast<int>(problem_.F.rows())));
  }

  double& entry(int row, int column) {
    const int* begin = H_.innerIndexPtr() + H_.outerIndexPtr()[column];
    const int* end = H_.innerIndexPtr() + H_.outerIndexPtr()[column + 1];
    return H_.valuePtr()[std::lower_bound(begin, end, row) - H_.innerIndexPtr()];
  }

  void assemble() {
    tbb::parallel_for(0, static_cast<int>(X_.rows()), [&](int v) {
      if (!active_[at(v)]) return;
      const Vector3d x = X_.row(v).transpose();
      basis_[at(v)] = tangent_basis(x);
      tangent_[at(v)] = lift_.derivative(x, hint_[at(v)]) * basis_[at(v)];
    });
    tbb::parallel_for(
        0, static_cast<int>(problem_.F.rows()), [&](int f) { systems_[at(f)] = face_system(f); });
    std::fill(H_.valuePtr(), H_.valuePtr() + H_.nonZeros(), 0.0);
    gradient_.setZero();
    for (int f = 0; f < problem_.F.rows(); ++f) {
      const FaceSystem& s = systems_[at(f)];
      for (int a = 0; a < 3; ++a) {
        const int i = unknown_[at(problem_.F(f, a))];
        if (i < 0) continue;
        gradient_.segment<2>(i) += s.g.segment<2>(2 * a);
        for (int b = 0; b < 3; ++b) {
          const int j = unknown_[at(problem_.F(f, b))];
          if (j < 0 || i < j) continue;
          for (int p = 0; p < 2; ++p)
            for (int q = 0; q < 2; ++q)
              if (i + p >= j + q) entry(i + p, j + q) += s.H(2 * a + p, 2 * b + q);
        }
      }
    }
  }

  bool solve() {
    // Rotations of the sphere leave some energies unchanged: a relative shift keeps the
    // factorisation definite.
    double trace = 0;
    for (int i = 0; i < H_.cols(); ++i) trace += H_.coeff(i, i);
    const double shift = 1e-9 * trace / std::max<double>(1, static_cast<double>(H_.cols()));
    for (int i = 0; i < H_.cols(); ++i) entry(i, i) += shift;
    solver_.factorize(H_);
    if (solver_.info() != Eigen::Success) return false;
    step_ = solver_.solve(-gradient_);
    return step_.allFinite();
  }

  /// The state after `t` times the step. Vertices of faces that would lose most of their
  /// orientation go a smaller part of the way: a few squeezed faces must not stop everybody.
  [[nodiscard]] MatrixX3d advance(double t) const {
    constexpr int kRounds = 8;
    constexpr double kKeep = 0.1;
    MatrixX3d X = X_;
    std::vector<double> part(at(static_cast<int>(X_.rows())), t);
    for (int round = 0; round < kRounds; ++round) {
      for (int v = 0; v < X_.rows(); ++v) {
        const int u = unknown_[at(v)];
        if (u < 0) continue;
        const Vector3d d = basis_[at(v)] * step_.segment<2>(u);
        X.row(v) = (X_.row(v).transpose() + part[at(v)] * d).normalized().transpose();
      }
      std::vector<bool> squeezed(part.size(), false);
      bool any = false;
      for (int f = 0; f < problem_.F.rows(); ++f) {
        const double before =
            sphere_orientation(corner(X_, f, 0), corner(X_, f, 1), corner(X_, f, 2));
        if (sphere_orientation(corner(X, f, 0), corner(X, f, 1), corner(X, f, 2)) > kKeep * before)
          continue;
        any = true;
        for (int k = 0; k < 3; ++k) squeezed[at(problem_.F(f, k))] = true;
      }
      if (!any) break;
      for (size_t v = 0; v < part.size(); ++v)
        if (squeezed[v]) part[v] /= 2;
    }
    return X;
  }

  /// Takes the longest of the steps 1, 1/2, 1/4, ... that turns no face over and lowers the energy.
  /// Returns the new energy, or the old one if no step does.
  double line_search(double energy) {
    MatrixX3d Y = Y_;
    constexpr int kHalvings = 12;
    double t = 1;
    for (int i = 0; i < kHalvings; ++i, t /= 2) {
      const MatrixX3d X = advance(t);
      std::vector<int> hint = hint_;
      const double e = evaluate(X, hint, Y);
      if (e < energy) {
        X_ = X;
        Y_ = Y;
        hint_ = std::move(hint);
        return e;
      }
    }
    return energy;
  }

  const SphereProblem& problem_;
  const Lift& lift_;
  const SphereOptimizerOptions& options_;
  MatrixX3d& X_;
  std::vector<int>& hint_;
  MatrixX3d Y_;
  Eigen::VectorXd reference_;  ///< of the barrier
  double total_area_ = 1;
  std::vector<bool> active_;
  std::vector<int> faces_begin_, faces_;  ///< faces around each vertex
  std::vector<int> unknown_;
  std::vector<Matrix32> basis_, tangent_;
  std::vector<FaceSystem> systems_;
  SparseMatrix H_;
  Eigen::VectorXd gradient_, step_;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> solver_;
};

}  // namespace

SphereProblem make_sphere_problem(MatrixX3i F, const MatrixX3d& V, const std::vector<int>& pinned) {
  constexpr double kSliver = 0.02;
  SphereProblem problem;
  problem.rest_inverse.resize(at(static_cast<int>(F.rows())));
  problem.rest_area.resize(F.rows());
  for (int f = 0; f < F.rows(); ++f) {
    const Vector3d u = (V.row(F(f, 1)) - V.row(F(f, 0))).transpose();
    const Vector3d v = (V.row(F(f, 2)) - V.row(F(f, 0))).transpose();
    const double longest = std::max({u.norm(), v.norm(), (u - v).norm(), 1e-12});
    const double base = std::max(u.norm(), kSliver * longest);
    const double x = u.norm() > 0 ? v.dot(u) / u.norm() : 0;
    const double height = std::max(u.cross(v).norm() / base, kSliver * longest);
    Eigen::Matrix2d E;
    E << base, x, 0, height;
    problem.rest_inverse[at(f)] = E.inverse();
    problem.rest_area[f] = 0.5 * base * height;
  }
  problem.reference_orientation =
      8 * std::numbers::pi / problem.rest_area.sum() * problem.rest_area;
  problem.fixed.assign(at(static_cast<int>(V.rows())), false);
  for (int v : pinned) problem.fixed[at(v)] = true;
  problem.F = std::move(F);
  return problem;
}

SphereOptimizerReport optimize_on_sphere(const SphereProblem& problem,
                                         const Lift& lift,
                                         const SphereOptimizerOptions& options,
                                         MatrixX3d& X,
                                         std::vector<int>& hint) {
  return Optimizer(problem, lift, options, X, hint).run();
}

double smallest_orientation(const MatrixX3i& F, const MatrixX3d& X) {
  double smallest = kInfinity;
  for (int f = 0; f < F.rows(); ++f)
    smallest = std::min(
        smallest,
        sphere_orientation(
            X.row(F(f, 0)).transpose(), X.row(F(f, 1)).transpose(), X.row(F(f, 2)).transpose()));
  return smallest;
}

}  // namespace crosspatch
