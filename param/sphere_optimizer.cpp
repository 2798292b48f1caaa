// Projected Newton steps for symmetric Dirichlet energies of triangulations that move on the sphere
// and are judged after a lift.
//
// Notation: a vertex has coordinates t in a frame (3 x 2) of the tangent plane at its lifted point,
// and goes straight ahead on the lift's surface: steps feel the surface's own metric, not the kinks
// of the lift. In the plane of a lifted face (axes P, 2 x 3) the Jacobian from the rest face is J =
// P [y1 - y0, y2 - y0] D, D the inverse rest edges.
#include "param/sphere_optimizer.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "core/blas.hpp"
#include "param/newton_solver.hpp"
#include "param/sphere_orientation.hpp"
#include "param/vertex_colours.hpp"

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
    vertex_area_ = Eigen::VectorXd::Zero(X.rows());
    for (int f = 0; f < problem.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) vertex_area_[problem.F(f, k)] += problem.rest_area[f] / 3;
  }

  SphereOptimizerReport run() {
    SphereOptimizerReport report;
    if (options_.distortion == Distortion::kNearlyConformal) refer_to_chords();
    double energy = evaluate(X_, hint_, Y_);
    report.energy_before = energy;
    // Common steps move whole limbs; where kinks of the lift or squeezed faces stop them, single
    // vertices still get on.
    int failures = 0;
    constexpr int kMostFailures = 4, kSweeps = 1;
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
    double fields = 0;
    if (problem_.fields != nullptr)
      for (int v = 0; v < X.rows(); ++v)
        if (unknown_[at(v)] >= 0) fields += field_energy(v, X.row(v).transpose(), hint[at(v)]);
    return (energy.sum() + fields) / total_area_;
  }

  /// Disagreement of the fields at one vertex, weighted.
  [[nodiscard]] double field_energy(int v, const Vector3d& x, int face) const {
    if (problem_.fields == nullptr) return 0;
    return problem_.field_weight * vertex_area_[v] *
           (lift_.values(x, face) - problem_.fields->row(v).transpose()).squaredNorm();
  }

  /// Adds it to the quadratic model in v's coordinates (Gauss-Newton).
  void add_fields(int v, Eigen::Matrix2d& H, Vector2d& g) const {
    if (problem_.fields == nullptr) return;
    const int face = hint_[at(v)];
    const Lift::Rates R = lift_.rates(face);
    const double weight = 2 * problem_.field_weight * vertex_area_[v] / total_area_;
    H += weight * R.transpose() * R;
    g += weight * R.transpose() *
         (lift_.values(X_.row(v).transpose(), face) - problem_.fields->row(v).transpose());
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

  /// One Newton step with a line search for each free vertex in turn, the others held. Vertices of
  /// one colour have no face in common and step at the same time.
  void sweep() {
    constexpr size_t kGrain = 32;
    for (const std::vector<int>& colour : colours_)
      tbb::parallel_for(tbb::blocked_range<size_t>(0, colour.size(), kGrain),
                        [&](const tbb::blocked_range<size_t>& range) {
                          for (size_t i = range.begin(); i < range.end(); ++i)
                            step_alone(colour[i]);
                        });
  }

  void step_alone(int v) {
    const Vector3d x = X_.row(v).transpose();
    frame_[at(v)] = lift_.frame(x, hint_[at(v)]);
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    Vector2d g = Vector2d::Zero();
    for (int f : faces_of(v)) {
      const FaceModel m = face_model(f);
      const int k = corner_of(f, v);
      const Rates J = rates(m, f, k);
      const Vector2d barrier = barrier_rate(m, f, k);
      H += m.weight * J.transpose() * m.energy.H * J + 2 * barrier * barrier.transpose();
      g += m.weight * J.transpose() * m.energy.g + 2 * m.barrier * barrier;
    }
    add_fields(v, H, g);
    const Vector2d step = -H.ldlt().solve(g);
    if (!step.allFinite()) return;
    const double energy = star_energy(v, x, Y_.row(v).transpose(), hint_[at(v)]);
    constexpr int kHalvings = 5;
    double t = 1;
    for (int i = 0; i < kHalvings; ++i, t /= 2) {
      int face = hint_[at(v)];
      const Vector3d moved = lift_.walk(x, face, t * frame_[at(v)].on_surface * step);
      const Vector3d y = lift_.point(moved, face);
      if (!(star_energy(v, moved, y, face) < energy)) continue;
      X_.row(v) = moved.transpose();
      Y_.row(v) = y.transpose();
      hint_[at(v)] = face;
      return;
    }
  }

  [[nodiscard]] double star_energy(int v, const Vector3d& x, const Vector3d& y, int face) const {
    double sum = field_energy(v, x, face);
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

  /// What a face's quadratic model is made of, apart from how its corners move.
  struct FaceModel {
    Eigen::Matrix<double, 2, 3> plane;  ///< orthonormal axes of the lifted face
    IsotropicHessian energy;
    double weight;   ///< share of the rest area
    double det;      ///< orientation on the sphere
    double barrier;  ///< residual whose square is the weighted barrier
  };
  using Rates = Eigen::Matrix<double, 4, 2>;

  [[nodiscard]] FaceModel face_model(int f) const {
    const Vector3d y0 = corner(Y_, f, 0), u = corner(Y_, f, 1) - y0, v = corner(Y_, f, 2) - y0;
    FaceModel m;
    m.plane.row(0) = u.normalized().transpose();
    m.plane.row(1) = u.cross(v).normalized().cross(m.plane.row(0).transpose()).transpose();
    Eigen::Matrix2d E;
    E << m.plane * u, m.plane * v;
    m.energy = isotropic_hessian(E * problem_.rest_inverse[at(f)], options_.distortion);
    m.weight = problem_.rest_area[f] / total_area_;
    m.det = sphere_orientation(corner(X_, f, 0), corner(X_, f, 1), corner(X_, f, 2));
    m.barrier = std::sqrt(m.weight * options_.barrier * reference_[f] / m.det);
    return m;
  }

  /// Derivatives of the Jacobian's entries in the coordinates of corner k.
  [[nodiscard]] Rates rates(const FaceModel& m, int f, int k) const {
    const Eigen::Matrix2d& D = problem_.rest_inverse[at(f)];
    // How the Jacobian follows the corner's place in the face's plane.
    const Eigen::RowVector2d s = k == 0 ? Eigen::RowVector2d(-D.colwise().sum()) : D.row(k - 1);
    const Eigen::Matrix2d M = m.plane * frame_[at(problem_.F(f, k))].on_surface;
    Rates r;
    r << s[0] * M, s[1] * M;
    return r;
  }

  /// Derivatives of the barrier's residual in the coordinates of corner k.
  [[nodiscard]] Vector2d barrier_rate(const FaceModel& m, int f, int k) const {
    const Vector3d normal = corner(X_, f, (k + 1) % 3).cross(corner(X_, f, (k + 2) % 3));
    return -0.5 * m.barrier / m.det * (frame_[at(problem_.F(f, k))].on_sphere.transpose() * normal);
  }

  [[nodiscard]] FaceSystem face_system(int f) const {
    const FaceModel m = face_model(f);
    Eigen::Matrix<double, 4, 6> G;
    Vector6 barrier;
    for (int k = 0; k < 3; ++k) {
      G.middleCols<2>(2 * k) = rates(m, f, k);
      barrier.segment<2>(2 * k) = barrier_rate(m, f, k);
    }
    return {m.weight * G.transpose() * m.energy.H * G + 2 * barrier * barrier.transpose(),
            m.weight * G.transpose() * m.energy.g + 2 * m.barrier * barrier};
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
    std::vector<bool> is_free(at(vertices));
    for (int v = 0; v < vertices; ++v) is_free[at(v)] = unknown_[at(v)] >= 0;
    colours_ = vertex_colours(problem_.F, is_free);
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
    solver_.analyze(H_);
    gradient_.resize(2 * n);
    frame_.resize(at(vertices));
    systems_.resize(at(static_cast<int>(problem_.F.rows())));
  }

  void assemble() {
    tbb::parallel_for(0, static_cast<int>(X_.rows()), [&](int v) {
      if (!active_[at(v)]) return;
      frame_[at(v)] = lift_.frame(X_.row(v).transpose(), hint_[at(v)]);
    });
    energy_.resize(problem_.F.rows());
    tbb::parallel_for(0, static_cast<int>(problem_.F.rows()), [&](int f) {
      systems_[at(f)] = face_system(f);
      energy_[f] = face_energy(f,
                               {corner(X_, f, 0), corner(X_, f, 1), corner(X_, f, 2)},
                               {corner(Y_, f, 0), corner(Y_, f, 1), corner(Y_, f, 2)});
    });
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
              if (i + p >= j + q) H_.coeffRef(i + p, j + q) += s.H(2 * a + p, 2 * b + q);
        }
      }
    }
    if (problem_.fields != nullptr) assemble_fields();
  }

  void assemble_fields() {
    for (int v = 0; v < X_.rows(); ++v) {
      const int i = unknown_[at(v)];
      if (i < 0) continue;
      Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
      Vector2d g = Vector2d::Zero();
      add_fields(v, H, g);
      gradient_.segment<2>(i) += g;
      for (int p = 0; p < 2; ++p)
        for (int q = 0; q <= p; ++q) H_.coeffRef(i + p, i + q) += H(p, q);
    }
  }

  bool solve() {
    // Rotations of the sphere and slides of symmetric surfaces leave some energies unchanged.
    for (int i = 0; i < H_.cols(); ++i) H_.coeffRef(i, i) += damping_;
    return solver_.solve(H_, -gradient_, step_);
  }

  /// The state after `t` times the step. Vertices of faces that would become much worse go a
  /// smaller part of the way: a few squeezed faces must not stop everybody.
  [[nodiscard]] MatrixX3d advance(double t) const {
    constexpr int kRounds = 24, kHalvings = 5;  // then they stay where they are
    constexpr double kWorse = 1.05, kSlack = 2;
    const int faces = static_cast<int>(problem_.F.rows());
    MatrixX3d X = X_, Y = Y_;
    std::vector<double> part(at(static_cast<int>(X_.rows())), t);
    std::vector<int> moving, touched(at(faces));  // vertices that move, and the faces around them
    for (int v = 0; v < X_.rows(); ++v)
      if (unknown_[at(v)] >= 0) moving.push_back(v);
    std::iota(touched.begin(), touched.end(), 0);
    std::vector<char> worse(at(faces), 0), marked(at(faces), 0), chosen(part.size(), 0);
    for (int round = 0; round < kRounds && !moving.empty(); ++round) {
      tbb::parallel_for(size_t{0}, moving.size(), [&](size_t i) {
        const int v = moving[i];
        const Vector3d d =
            part[at(v)] * frame_[at(v)].on_surface * step_.segment<2>(unknown_[at(v)]);
        int face = hint_[at(v)];
        X.row(v) = lift_.walk(X_.row(v).transpose(), face, d).transpose();
        Y.row(v) = lift_.point(X.row(v).transpose(), face).transpose();
      });
      tbb::parallel_for(size_t{0}, touched.size(), [&](size_t i) {
        const int f = touched[i];
        const double after = face_energy(f,
                                         {corner(X, f, 0), corner(X, f, 1), corner(X, f, 2)},
                                         {corner(Y, f, 0), corner(Y, f, 1), corner(Y, f, 2)});
        worse[at(f)] = after > kWorse * energy_[f] + kSlack * problem_.rest_area[f] ? 1 : 0;
      });
      moving.clear();
      for (const int f : touched)
        if (worse[at(f)] != 0)
          for (int k = 0; k < 3; ++k)
            if (const int v = problem_.F(f, k); unknown_[at(v)] >= 0 && chosen[at(v)] == 0) {
              chosen[at(v)] = 1;
              moving.push_back(v);
            }
      touched.clear();
      for (const int v : moving) {
        part[at(v)] = round < kHalvings ? part[at(v)] / 2 : 0;
        chosen[at(v)] = 0;
        for (const int f : faces_of(v))
          if (marked[at(f)] == 0) {
            marked[at(f)] = 1;
            touched.push_back(f);
          }
      }
      for (const int f : touched) marked[at(f)] = 0;
    }
    return X;
  }

  /// Takes the longest of the steps 1, 1/2, 1/4, ... that turns no face over and lowers the energy.
  /// Returns the new energy, or the old one if no step does.
  double line_search(double energy) {
    MatrixX3d Y = Y_;
    constexpr int kHalvings = 8;
    constexpr double kLeast = 1e-5, kMost = 10, kFactor = 8;  // of the damping
    double t = 1;
    for (int i = 0; i < kHalvings; ++i, t /= 2) {
      const MatrixX3d X = advance(t);
      std::vector<int> hint = hint_;
      const double e = evaluate(X, hint, Y);
      if (e < energy) {
        if (i == 0) damping_ = std::max(kLeast, damping_ / kFactor);
        if (i > 1) damping_ = std::min(kMost, damping_ * kFactor);
        X_ = X;
        Y_ = Y;
        hint_ = std::move(hint);
        return e;
      }
    }
    damping_ = std::min(kMost, damping_ * kFactor * kFactor);
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
  Eigen::VectorXd vertex_area_;  ///< a third of the faces around each vertex
  std::vector<bool> active_;
  std::vector<int> faces_begin_, faces_;  ///< faces around each vertex
  std::vector<int> unknown_;
  std::vector<std::vector<int>> colours_;  ///< free vertices
  std::vector<Lift::Frame> frame_;         ///< per vertex
  std::vector<FaceSystem> systems_;
  double damping_ = 1e-2;   ///< of the steps; diagonal entries of a good map's Hessian are about 30
  Eigen::VectorXd energy_;  ///< per face, where the systems were assembled
  SparseMatrix H_;
  Eigen::VectorXd gradient_, step_;
  NewtonSolver solver_;
  SingleThreadedBlas blas_;
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
