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

#include "param/newton_system.hpp"
#include "param/sphere_orientation.hpp"
#include "param/vertex_colours.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Matrix32 = Eigen::Matrix<double, 3, 2>;

size_t at(int i) {
  return static_cast<size_t>(i);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The coordinates of the vertices that move, see NewtonSystem.
std::vector<int> number_unknowns(const SphereProblem& problem) {
  std::vector<int> unknown(problem.fixed.size(), -1);
  for (const int v : problem.F.reshaped()) unknown[at(v)] = 0;
  int n = 0;
  for (size_t v = 0; v < unknown.size(); ++v)
    unknown[v] = unknown[v] == 0 && !problem.fixed[v] ? 2 * n++ : -1;
  return unknown;
}

class Optimizer {
 public:
  Optimizer(const SphereProblem& problem,
            const Lift& lift,
            const SphereOptimizerOptions& options,
            MatrixX3d& X,
            std::vector<int>& hint)
      : problem_(problem),
        lift_(lift),
        options_(options),
        X_(X),
        hint_(hint),
        system_(problem.F, number_unknowns(problem)) {
    Y_.resize(X.rows(), 3);
    reference_ = problem.reference_orientation;
    total_area_ = problem.rest_area.sum();
    collect_stars();
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
    constexpr int kLongestPause = 15;  // energies end about alike with any up to 31
    int pause = 0, wait = 0;  // iterations without a common step: after the next one, and left
    for (; report.iterations < options_.max_iterations; ++report.iterations) {
      if (options_.distortion == Distortion::kNearlyConformal) {
        refer_to_chords();
        energy = evaluate(X_, hint_, Y_);
      }
      const double before = energy;
      const bool together = wait == 0;
      double lower = energy;
      if (together) {
        assemble();
        if (system_.solve(damping_, step_)) lower = line_search(energy);
        if (lower < energy) std::fill(moved_.begin(), moved_.end(), ++now_);
      }
      sweep();
      energy = evaluate(X_, hint_, Y_);
      if (together) {
        pause = before - lower < lower - energy ? std::min(2 * pause + 1, kLongestPause) : 0;
        wait = pause;
      } else {
        --wait;
      }
      if (before - energy >= options_.relative_decrease * std::abs(before)) continue;
      if (together) {
        ++report.iterations;
        break;
      }
      wait = 0;
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
    tbb::parallel_for(0, static_cast<int>(X.rows()), [&](int v) {
      if (active_[at(v)]) Y.row(v) = lift_.point(X.row(v).transpose(), hint[at(v)]).transpose();
    });
    Eigen::VectorXd energy(faces);
    tbb::parallel_for(0, faces, [&](int f) {
      energy[f] = face_energy(f,
                              {corner(X, f, 0), corner(X, f, 1), corner(X, f, 2)},
                              {corner(Y, f, 0), corner(Y, f, 1), corner(Y, f, 2)});
    });
    if (problem_.fields == nullptr) return energy.sum() / total_area_;
    Eigen::VectorXd fields = Eigen::VectorXd::Zero(X.rows());
    tbb::parallel_for(0, static_cast<int>(X.rows()), [&](int v) {
      if (system_.unknown(v) >= 0) fields[v] = field_energy(v, X.row(v).transpose(), hint[at(v)]);
    });
    return (energy.sum() + fields.sum()) / total_area_;
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

  /// One Newton step with a line search for each free vertex in turn, the others held, but for
  /// those around which nothing has moved since their last. Vertices of one colour have no face in
  /// common and step at the same time.
  void sweep() {
    constexpr size_t kGrain = 32;
    for (const std::vector<int>& colour : colours_) {
      ++now_;
      tbb::parallel_for(tbb::blocked_range<size_t>(0, colour.size(), kGrain),
                        [&](const tbb::blocked_range<size_t>& range) {
                          for (size_t i = range.begin(); i < range.end(); ++i) {
                            const int v = colour[i];
                            if (!has_changed(v)) continue;
                            tried_[at(v)] = now_;
                            if (step_alone(v)) moved_[at(v)] = now_;
                          }
                        });
    }
  }

  [[nodiscard]] bool has_changed(int v) const {
    for (const int f : faces_of(v))
      for (int k = 0; k < 3; ++k)
        if (moved_[at(problem_.F(f, k))] >= tried_[at(v)]) return true;
    return false;
  }

  /// Whether it gains what is worth mentioning.
  bool step_alone(int v) {
    const Vector3d x = X_.row(v).transpose();
    frame_[at(v)] = lift_.frame(x, hint_[at(v)]);
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    Vector2d g = Vector2d::Zero();
    for (int f : faces_of(v)) {
      const FaceModel m = face_model(f);
      const CornerRates c = corner_rates(m, f, corner_of(f, v));
      H += hessian_block(m, c, c);
      g += gradient_part(m, c);
    }
    add_fields(v, H, g);
    const Vector2d step = -H.ldlt().solve(g);
    if (!step.allFinite()) return false;
    const double energy = star_energy(v, x, Y_.row(v).transpose(), hint_[at(v)]);
    constexpr int kHalvings = 5;
    double t = 1;
    for (int i = 0; i < kHalvings; ++i, t /= 2) {
      int face = hint_[at(v)];
      const Vector3d moved = lift_.walk(x, face, t * frame_[at(v)].on_surface * step);
      const Vector3d y = lift_.point(moved, face);
      const double lower = star_energy(v, moved, y, face);
      if (!(lower < energy)) continue;
      X_.row(v) = moved.transpose();
      Y_.row(v) = y.transpose();
      hint_[at(v)] = face;
      constexpr double kWorthwhile = 5e-4;  // from 0 to 2e-3 energies end alike
      return energy - lower > kWorthwhile * energy;
    }
    return false;
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
  /// How a face follows one corner's coordinates.
  struct CornerRates {
    Eigen::RowVector2d by_place;  ///< column j of the Jacobian moves by by_place[j] times ...
    Eigen::Matrix2d place;        ///< ... how the corner moves in the face's plane
    Vector2d barrier;             ///< derivatives of the barrier's residual
  };

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

  [[nodiscard]] CornerRates corner_rates(const FaceModel& m, int f, int k) const {
    const Eigen::Matrix2d& D = problem_.rest_inverse[at(f)];
    const Lift::Frame& frame = frame_[at(problem_.F(f, k))];
    const Vector3d normal = corner(X_, f, (k + 1) % 3).cross(corner(X_, f, (k + 2) % 3));
    return {k == 0 ? Eigen::RowVector2d(-D.colwise().sum()) : Eigen::RowVector2d(D.row(k - 1)),
            m.plane * frame.on_surface,
            -0.5 * m.barrier / m.det * (frame.on_sphere.transpose() * normal)};
  }

  /// The block of a face's Hessian in the coordinates of two of its corners (rows: a, columns: b).
  [[nodiscard]] static Eigen::Matrix2d hessian_block(const FaceModel& m,
                                                     const CornerRates& a,
                                                     const CornerRates& b) {
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        H += a.by_place[i] * b.by_place[j] * m.energy.H.block<2, 2>(2 * i, 2 * j);
    return m.weight * (a.place.transpose() * H * b.place) + 2 * a.barrier * b.barrier.transpose();
  }

  [[nodiscard]] static Vector2d gradient_part(const FaceModel& m, const CornerRates& c) {
    const Vector2d g = c.by_place[0] * m.energy.g.head<2>() + c.by_place[1] * m.energy.g.tail<2>();
    return m.weight * (c.place.transpose() * g) + 2 * m.barrier * c.barrier;
  }

  [[nodiscard]] FaceSystem face_system(int f) const {
    const FaceModel m = face_model(f);
    const std::array<CornerRates, 3> c{
        corner_rates(m, f, 0), corner_rates(m, f, 1), corner_rates(m, f, 2)};
    FaceSystem s;
    for (size_t a = 0; a < 3; ++a) {
      s.g[a] = gradient_part(m, c[a]);
      for (size_t b = 0; b <= a; ++b) s.H[FaceSystem::block(a, b)] = hessian_block(m, c[a], c[b]);
    }
    return s;
  }

  void collect_stars() {
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
    std::vector<bool> is_free(at(vertices));
    for (int v = 0; v < vertices; ++v) is_free[at(v)] = system_.unknown(v) >= 0;
    colours_ = vertex_colours(problem_.F, is_free);
    moved_.assign(at(vertices), 0);
    tried_.assign(at(vertices), 0);
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
    system_.assemble(systems_);
    if (problem_.fields != nullptr) assemble_fields();
  }

  void assemble_fields() {
    for (int v = 0; v < X_.rows(); ++v) {
      if (system_.unknown(v) < 0) continue;
      Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
      Vector2d g = Vector2d::Zero();
      add_fields(v, H, g);
      system_.add(v, H, g);
    }
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
      if (system_.unknown(v) >= 0) moving.push_back(v);
    std::iota(touched.begin(), touched.end(), 0);
    std::vector<char> worse(at(faces), 0), marked(at(faces), 0), chosen(part.size(), 0);
    for (int round = 0; round < kRounds && !moving.empty(); ++round) {
      tbb::parallel_for(size_t{0}, moving.size(), [&](size_t i) {
        const int v = moving[i];
        const Vector3d d =
            part[at(v)] * frame_[at(v)].on_surface * step_.segment<2>(system_.unknown(v));
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
            if (const int v = problem_.F(f, k); system_.unknown(v) >= 0 && chosen[at(v)] == 0) {
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
  std::vector<int> faces_begin_, faces_;   ///< faces around each vertex
  std::vector<std::vector<int>> colours_;  ///< free vertices
  std::vector<Lift::Frame> frame_;         ///< per vertex
  int now_ = 0;                            ///< counts common steps and sweeps over one colour
  std::vector<int> moved_, tried_;  ///< per vertex: when it last moved, and last stepped alone
  std::vector<FaceSystem> systems_;
  /// Of the steps. Rotations of the sphere and slides of symmetric surfaces leave some energies
  /// unchanged.
  double damping_ = 1e-2;   ///< diagonal entries of a good map's Hessian are about 30
  Eigen::VectorXd energy_;  ///< per face, where the systems were assembled
  Eigen::VectorXd step_;
  NewtonSystem system_;
};

}  // namespace

Eigen::Matrix2d thickened_sides(const Vector3d& u, const Vector3d& v) {
  constexpr double kSliver = 0.02;
  const double longest = std::max({u.norm(), v.norm(), (u - v).norm(), 1e-12});
  const double base = std::max(u.norm(), kSliver * longest);
  const double x = u.norm() > 0 ? v.dot(u) / u.norm() : 0;
  const double height = std::max(u.cross(v).norm() / base, kSliver * longest);
  Eigen::Matrix2d E;
  E << base, x, 0, height;
  return E;
}

SphereProblem make_sphere_problem(MatrixX3i F, const MatrixX3d& V, const std::vector<int>& pinned) {
  SphereProblem problem;
  problem.rest_inverse.resize(at(static_cast<int>(F.rows())));
  problem.rest_area.resize(F.rows());
  for (int f = 0; f < F.rows(); ++f) {
    const Vector3d u = (V.row(F(f, 1)) - V.row(F(f, 0))).transpose();
    const Vector3d v = (V.row(F(f, 2)) - V.row(F(f, 0))).transpose();
    const Eigen::Matrix2d E = thickened_sides(u, v);
    problem.rest_inverse[at(f)] = E.inverse();
    problem.rest_area[f] = 0.5 * E.determinant();
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
