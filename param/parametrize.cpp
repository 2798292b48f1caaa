#include "param/parametrize.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/blas.hpp"
#include "core/index.hpp"
#include "param/symmetric_dirichlet.hpp"
#include "param/tutte.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Matrix4x6 = Eigen::Matrix<double, 4, 6, Eigen::RowMajor>;

/// How a vertex may move: by basis.leftCols(freedom) times its step.
struct Motion {
  int freedom = 2;
  Eigen::Matrix2d basis = Eigen::Matrix2d::Identity();
};

/// Unit vector along b - a, exactly on an axis where it is within rounding of one.
Vector2d side_direction(const Vector2d& a, const Vector2d& b) {
  Vector2d d = (b - a).normalized();
  for (int i = 0; i < 2; ++i)
    if (std::abs(d[i]) < 1e-12) d[i] = 0;
  return d.normalized();
}

void slide(Motion& motion, const Vector2d& direction) {
  motion.freedom = 1;
  motion.basis.col(0) = direction;
}

std::vector<Motion> vertex_motions(const TriangleMesh& disc,
                                   const MatrixX2d& uv,
                                   PatchBoundary boundary) {
  std::vector<Motion> motion(idx(disc.vertex_count()));
  const std::vector<std::vector<int>> loops = boundary_loops(disc);
  if (boundary == PatchBoundary::kFree && !loops.empty()) {
    // Translations and rotations change nothing: pin a vertex and the direction to the farthest.
    const std::vector<int>& loop = loops.front();
    int farthest = loop.front();
    const auto distance = [&](int v) { return (uv.row(v) - uv.row(loop.front())).norm(); };
    for (const int v : loop)
      if (distance(v) > distance(farthest)) farthest = v;
    motion[idx(loop.front())].freedom = 0;
    slide(motion[idx(farthest)], side_direction(uv.row(loop.front()), uv.row(farthest)));
    return motion;
  }
  constexpr double kStraight = 1e-9;  // sine of the turn that rounding leaves on a straight side
  for (const std::vector<int>& loop : loops)
    for (size_t i = 0; i < loop.size(); ++i) {
      const Vector2d a = uv.row(loop[(i + loop.size() - 1) % loop.size()]), b = uv.row(loop[i]);
      const Vector2d c = uv.row(loop[(i + 1) % loop.size()]);
      const Vector2d d = b - a, e = c - b;
      const double sine = (d.x() * e.y() - d.y() * e.x()) / (d.norm() * e.norm());
      Motion& m = motion[idx(loop[i])];
      m.freedom = 0;
      if (boundary == PatchBoundary::kSliding && std::abs(sine) < kStraight && d.dot(e) > 0)
        slide(m, side_direction(a, c));
    }
  return motion;
}

/// The linearised, weighted residuals of one triangle, as functions of the steps of its vertices.
/// The 8 residuals depend on the 4 entries of J only; these 4 rows have the same normal equations.
struct LinearModel {
  Eigen::Matrix<double, 4, 1> residual;
  Matrix4x6 slope;  ///< columns 2 k, 2 k + 1: the step of corner k
};

class LinearCost final : public ceres::CostFunction {
 public:
  /// `corners`: those that move, in the order of the parameter blocks.
  LinearCost(const LinearModel* model, std::vector<std::pair<int, int>> corner_and_freedom)
      : model_(model), blocks_(std::move(corner_and_freedom)) {
    set_num_residuals(4);
    for (const auto& [corner, freedom] : blocks_)
      mutable_parameter_block_sizes()->push_back(freedom);
  }

  bool Evaluate(double const* const* x, double* residual, double** slope) const override {
    Eigen::Map<Eigen::Matrix<double, 4, 1>> r(residual);
    r = model_->residual;
    for (size_t b = 0; b < blocks_.size(); ++b) {
      const auto [corner, freedom] = blocks_[b];
      for (int j = 0; j < freedom; ++j) r += x[b][j] * model_->slope.col(2 * corner + j);
      if (slope == nullptr || slope[b] == nullptr) continue;
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < freedom; ++j)
          slope[b][i * freedom + j] = model_->slope(i, 2 * corner + j);
    }
    return true;
  }

 private:
  const LinearModel* model_;
  std::vector<std::pair<int, int>> blocks_;
};

LinearModel linearise(const RestTriangle& rest,
                      const std::array<Vector2d, 3>& p,
                      const std::array<const Motion*, 3>& motion,
                      double stiffness) {
  const DirichletTerm term = symmetric_dirichlet(rest, jacobian(rest, p[0], p[1], p[2]));
  const Eigen::LLT<Eigen::Matrix4d> factor(term.by_jacobian.transpose() * term.by_jacobian);
  const double root = std::sqrt(stiffness);
  LinearModel m;
  m.residual = factor.matrixL().solve(term.by_jacobian.transpose() * term.residual) * root;
  const Eigen::Matrix4d R = Eigen::Matrix4d(factor.matrixU()) * root;
  const Eigen::Matrix<double, 3, 2> G = corner_gradients(rest);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < motion[static_cast<size_t>(k)]->freedom; ++j) {
      const Vector2d d = motion[static_cast<size_t>(k)]->basis.col(j);
      Eigen::Vector4d step;
      step << d.x() * G(k, 0), d.x() * G(k, 1), d.y() * G(k, 0), d.y() * G(k, 1);
      m.slope.col(2 * k + j) = R * step;
    }
  return m;
}

/// The patch during its rounds.
class Rounds {
 public:
  Rounds(const TriangleMesh& disc, const MatrixX2d& start, PatchBoundary boundary)
      : disc_(disc),
        uv_(start),
        motion_(vertex_motions(disc, start, boundary)),
        model_(idx(disc.face_count())),
        stiffness_(idx(disc.face_count()), 1.0),
        step_(2 * idx(disc.vertex_count()), 0.0) {
    double image = 0;
    for (int f = 0; f < disc.face_count(); ++f) {
      const Vector2d a = uv_.row(disc.F(f, 0));
      const Vector2d d = uv_.row(disc.F(f, 1)).transpose() - a;
      const Vector2d e = uv_.row(disc.F(f, 2)).transpose() - a;
      image += (d.x() * e.y() - d.y() * e.x()) / 2;
    }
    rest_ = rest_triangles(disc, std::sqrt(image / total_area(disc)));
    build_problem();
  }

  [[nodiscard]] const MatrixX2d& uv() const { return uv_; }
  [[nodiscard]] double energy() const { return symmetric_dirichlet_energy(rest_, disc_.F, uv_); }
  [[nodiscard]] double weighted_energy(const MatrixX2d& uv) const;
  [[nodiscard]] double largest_stiffness() const {
    return *std::max_element(stiffness_.begin(), stiffness_.end());
  }
  [[nodiscard]] double worst_stretch() const;

  /// Solves for the step of this round; false where Ceres gives none.
  bool solve();
  /// Moves along the step; returns the share by which the weighted energy fell.
  double advance();
  /// Raises the weight of triangles more distorted than their neighbours.
  void stiffen(double factor, double limit);
  /// Back to the image and the weights before the last stiffening.
  void undo_stiffening();

 private:
  [[nodiscard]] Eigen::Matrix2d face_jacobian(int f, const MatrixX2d& uv) const {
    return jacobian(
        rest_[idx(f)], uv.row(disc_.F(f, 0)), uv.row(disc_.F(f, 1)), uv.row(disc_.F(f, 2)));
  }
  void build_problem();
  [[nodiscard]] double first_inversion(const MatrixX2d& move) const;
  /// Derivative of the weighted energy along `move`.
  [[nodiscard]] double energy_slope(const MatrixX2d& move) const;

  const TriangleMesh& disc_;
  MatrixX2d uv_;
  std::vector<Motion> motion_;
  std::vector<RestTriangle> rest_;
  std::vector<LinearModel> model_;
  std::vector<double> stiffness_;
  MatrixX2d uv_before_stiffening_;
  std::vector<double> stiffness_before_;
  std::vector<double> step_;  ///< two numbers a vertex, in the basis of its motion
  std::unique_ptr<ceres::Problem> problem_;
};

void Rounds::build_problem() {
  ceres::Problem::Options options;
  options.disable_all_safety_checks = true;
  problem_ = std::make_unique<ceres::Problem>(options);
  for (int v = 0; v < disc_.vertex_count(); ++v)
    if (motion_[idx(v)].freedom > 0)
      problem_->AddParameterBlock(&step_[2 * idx(v)], motion_[idx(v)].freedom);
  for (int f = 0; f < disc_.face_count(); ++f) {
    std::vector<std::pair<int, int>> blocks;
    std::vector<double*> steps;
    for (int k = 0; k < 3; ++k) {
      const int v = disc_.F(f, k);
      if (motion_[idx(v)].freedom == 0) continue;
      blocks.emplace_back(k, motion_[idx(v)].freedom);
      steps.push_back(&step_[2 * idx(v)]);
    }
    if (!steps.empty())
      problem_->AddResidualBlock(
          new LinearCost(&model_[idx(f)], std::move(blocks)), nullptr, steps);  // owned by problem_
  }
}

double Rounds::weighted_energy(const MatrixX2d& uv) const {
  double energy = 0;
  for (int f = 0; f < disc_.face_count(); ++f) {
    const Eigen::Matrix2d J = face_jacobian(f, uv);
    const double det = J.determinant();
    if (!(det > 0)) return std::numeric_limits<double>::infinity();
    energy += stiffness_[idx(f)] * rest_[idx(f)].area * J.squaredNorm() * (1 + 1 / (det * det));
  }
  return energy;
}

double Rounds::worst_stretch() const {
  double worst = 1;
  for (int f = 0; f < disc_.face_count(); ++f) {
    const Vector2d s = singular_values(face_jacobian(f, uv_));
    worst = std::max({worst, s[0], 1 / s[1]});
  }
  return worst;
}

bool Rounds::solve() {
  for (int f = 0; f < disc_.face_count(); ++f) {
    std::array<Vector2d, 3> p;
    std::array<const Motion*, 3> motion{};
    for (size_t k = 0; k < 3; ++k) {
      const int v = disc_.F(f, static_cast<int>(k));
      p[k] = uv_.row(v);
      motion[k] = &motion_[idx(v)];
    }
    model_[idx(f)] = linearise(rest_[idx(f)], p, motion, stiffness_[idx(f)]);
  }
  std::fill(step_.begin(), step_.end(), 0.0);
  if (problem_->NumResiduals() == 0) return true;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.max_num_iterations = 1;
  options.initial_trust_region_radius = 1e12;
  options.max_trust_region_radius = 1e13;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  return summary.IsSolutionUsable();
}

double Rounds::first_inversion(const MatrixX2d& move) const {
  double first = std::numeric_limits<double>::infinity();
  for (int f = 0; f < disc_.face_count(); ++f) {
    // det(J + t dJ) = det J + t (cofactors of J . dJ) + t^2 det dJ.
    const Eigen::Matrix2d J = face_jacobian(f, uv_), D = face_jacobian(f, move);
    const double c = J.determinant(), a = D.determinant();
    const double b = J(0, 0) * D(1, 1) + J(1, 1) * D(0, 0) - J(0, 1) * D(1, 0) - J(1, 0) * D(0, 1);
    const double square = b * b - 4 * a * c;
    if (square < 0) continue;
    // The smaller positive root without cancellation; c > 0.
    const double q = -b + (b > 0 ? -1 : 1) * std::sqrt(square);
    for (const double t : {2 * c / q, q / (2 * a)})
      if (t > 0 && t < first) first = t;
  }
  return first;
}

double Rounds::advance() {
  MatrixX2d move(disc_.vertex_count(), 2);
  for (int v = 0; v < disc_.vertex_count(); ++v) {
    const Motion& m = motion_[idx(v)];
    Vector2d d = Vector2d::Zero();
    for (int j = 0; j < m.freedom; ++j) d += step_[2 * idx(v) + idx(j)] * m.basis.col(j);
    move.row(v) = d;
  }
  // Gauss-Newton steps are twice too long near an isometry, so a mere decrease would let them swing
  // to and fro; Armijo's condition asks for a share of the fall that the slope promises.
  constexpr double kArmijo = 0.2;
  constexpr int kHalvings = 40;
  const double before = weighted_energy(uv_), slope = energy_slope(move);
  double t = std::min(1.0, 0.9 * first_inversion(move));
  for (int i = 0; i < kHalvings; ++i, t /= 2) {
    MatrixX2d moved = uv_ + t * move;
    const double after = weighted_energy(moved);
    if (!(after <= before + kArmijo * t * slope) || !folded_faces(disc_, moved).empty()) continue;
    uv_ = std::move(moved);
    return (before - after) / before;
  }
  return 0;
}

double Rounds::energy_slope(const MatrixX2d& move) const {
  double slope = 0;
  for (int f = 0; f < disc_.face_count(); ++f) {
    const Eigen::Matrix2d J = face_jacobian(f, uv_), inverse = J.inverse();
    const Eigen::Matrix2d gradient = 2 * (J - inverse.transpose() * inverse * inverse.transpose());
    slope += stiffness_[idx(f)] * rest_[idx(f)].area *
             gradient.cwiseProduct(face_jacobian(f, move)).sum();
  }
  return slope;
}

void Rounds::undo_stiffening() {
  uv_ = uv_before_stiffening_;
  stiffness_ = stiffness_before_;
}

void Rounds::stiffen(double factor, double limit) {
  uv_before_stiffening_ = uv_;
  stiffness_before_ = stiffness_;
  std::vector<double> distortion(idx(disc_.face_count()));
  for (int f = 0; f < disc_.face_count(); ++f) {
    const Vector2d s = singular_values(face_jacobian(f, uv_));
    distortion[idx(f)] = std::abs(s[0] - 1) + std::abs(s[1] - 1);
  }
  for (int f = 0; f < disc_.face_count(); ++f) {
    double laplacian = 0;
    for (int k = 0; k < 3; ++k)
      if (const int g = disc_.twin[idx(3 * f + k)]; g >= 0)
        laplacian += distortion[idx(f)] - distortion[idx(face_of(g))];
    stiffness_[idx(f)] += std::min(factor * std::abs(laplacian), limit);
  }
}

}  // namespace

Result<PatchParametrization> parametrize(const TriangleMesh& disc,
                                         const MatrixX2d& start,
                                         const ParametrizeOptions& options) {
  if (start.rows() != disc.vertex_count())
    return fail(
        ErrorCode::kBadInput,
        fmt::format("patch: {} positions for {} vertices", start.rows(), disc.vertex_count()));
  if (const std::vector<int> folded = folded_faces(disc, start); !folded.empty())
    return fail(ErrorCode::kBadInput,
                fmt::format("patch: {} triangles of the start are not positive, first {}",
                            folded.size(),
                            folded.front()));
  const SingleThreadedBlas one_thread;
  Rounds rounds(disc, start, options.boundary);
  PatchParametrization r;
  r.energy_before = rounds.energy();
  r.worst_stretch_before = rounds.worst_stretch();
  constexpr double kSettled = 1e-3;  // fall of a round below which weights are worth changing
  int stiffenings_left = options.stiffening_rounds;
  double lowest_worst = std::numeric_limits<double>::infinity();
  while (r.rounds < options.max_rounds && !r.converged) {
    if (!rounds.solve()) {
      if (r.rounds == 0) return fail(ErrorCode::kNumerical, "patch: Ceres found no step");
      break;
    }
    const double fall = rounds.advance();
    ++r.rounds;
    if (stiffenings_left > 0 && fall < kSettled) {
      if (rounds.worst_stretch() < lowest_worst) {
        lowest_worst = rounds.worst_stretch();
        rounds.stiffen(options.stiffening_factor, options.stiffening_limit);
        --stiffenings_left;
      } else {
        rounds.undo_stiffening();
        stiffenings_left = 0;
      }
    } else {
      r.converged = fall < options.tolerance;
    }
  }
  r.uv = rounds.uv();
  r.energy_after = rounds.energy();
  r.worst_stretch_after = rounds.worst_stretch();
  r.largest_stiffness = rounds.largest_stiffness();
  return r;
}

}  // namespace crosspatch
