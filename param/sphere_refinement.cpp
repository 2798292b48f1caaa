#include "param/sphere_refinement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "param/ring_kernel.hpp"
#include "param/sphere_orientation.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Places single vertices inside the rings of their neighbours.
class Placer {
 public:
  Placer(const Refinement& refinement,
         const MatrixX3d& V,
         const Lift& lift,
         Distortion distortion,
         MatrixX3d& X,
         std::vector<int>& hint)
      : refinement_(refinement), V_(V), lift_(lift), distortion_(distortion), X_(X), hint_(hint) {}

  /// Puts `v` where its faces have the least energy. `near` is the vertex it was just split from,
  /// or v itself to move it from a valid place. False if no place is left.
  bool place(int v, int near) {
    collect(v);
    const Vector3d center = X_.row(near).transpose();
    const RingKernel kernel(X_, ring_, center, near);
    if (kernel.corners().empty()) return false;
    const Vector2d middle = kernel.centroid();
    double best = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Vector3d& x) {
      int face = hint_[at(near)];
      const double e = energy(x, face);
      if (e < best) {
        best = e;
        X_.row(v) = x.transpose();
        hint_[at(v)] = face;
      }
    };
    if (near == v) consider(center);
    consider(kernel.on_sphere(middle));
    for (const double s : {0.5, 0.8})
      for (const Vector2d& corner : kernel.corners())
        consider(kernel.on_sphere(middle + s * (corner - middle)));
    return std::isfinite(best);
  }

 private:
  void collect(int v) {
    ring_.clear();
    rest_.clear();
    for (int f : refinement_.faces(v)) {
      int k = 0;
      while (refinement_.F()(f, k) != v) ++k;
      ring_.emplace_back(refinement_.F()(f, (k + 1) % 3), refinement_.F()(f, (k + 2) % 3));
    }
    MatrixX3i F(static_cast<int>(ring_.size()), 3);
    for (int i = 0; i < F.rows(); ++i) F.row(i) << v, ring_[at(i)].first, ring_[at(i)].second;
    const SphereProblem shapes = make_sphere_problem(F, V_, {});
    rest_ = shapes.rest_inverse;
    area_ = shapes.rest_area;
  }

  double energy(const Vector3d& x, int& face) const {
    const Vector3d y = lift_.point(x, face);
    double sum = 0;
    for (size_t i = 0; i < ring_.size(); ++i) {
      const Vector3d p = X_.row(ring_[i].first).transpose(),
                     q = X_.row(ring_[i].second).transpose();
      if (!(sphere_orientation(x, p, q) > 0)) return std::numeric_limits<double>::infinity();
      int fp = hint_[at(ring_[i].first)], fq = hint_[at(ring_[i].second)];
      sum += area_[static_cast<int>(i)] *
             distortion(distortion_, rest_[i], y, lift_.point(p, fp), lift_.point(q, fq));
    }
    return sum;
  }

  const Refinement& refinement_;
  const MatrixX3d& V_;
  const Lift& lift_;
  Distortion distortion_;
  MatrixX3d& X_;
  std::vector<int>& hint_;
  std::vector<std::pair<int, int>> ring_;
  std::vector<Eigen::Matrix2d> rest_;
  Eigen::VectorXd area_;
};

/// Vertices of faces whose energy exceeds `bound`.
std::vector<int> vertices_above(const SphereProblem& problem,
                                const Lift& lift,
                                double bound,
                                const MatrixX3d& X,
                                std::vector<int>& hint) {
  std::vector<int> vertices;
  for (int f = 0; f < problem.F.rows(); ++f) {
    Vector3d y[3];
    for (int k = 0; k < 3; ++k)
      y[k] = lift.point(X.row(problem.F(f, k)).transpose(), hint[at(problem.F(f, k))]);
    if (distortion(Distortion::kBothWays, problem.rest_inverse[at(f)], y[0], y[1], y[2]) > bound)
      for (int k = 0; k < 3; ++k) vertices.push_back(problem.F(f, k));
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

/// Gives the faces within a few edges of v better shapes on the sphere, whatever they become on the
/// surface.
void make_room(const Refinement& level,
               const MatrixX3d& V,
               int v,
               const std::vector<int>& pinned,
               MatrixX3d& X) {
  constexpr int kRings = 3;
  std::vector<int> inner{v};
  for (int i = 1; i < kRings; ++i) {
    const std::vector<int> ring = inner;
    for (const int u : ring) {
      const std::vector<int> more = level.neighbours(u);
      inner.insert(inner.end(), more.begin(), more.end());
    }
    std::sort(inner.begin(), inner.end());
    inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
  }
  std::vector<int> faces;
  for (const int u : inner) faces.insert(faces.end(), level.faces(u).begin(), level.faces(u).end());
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  SphereProblem problem = make_sphere_problem(level.F()(faces, Eigen::all), V, pinned);
  for (const int u : problem.F.reshaped())
    if (!std::binary_search(inner.begin(), inner.end(), u)) problem.fixed[at(u)] = true;
  std::vector<int> unused(at(static_cast<int>(X.rows())), 0);
  optimize_on_sphere(problem,
                     SphereLift(),
                     {.distortion = Distortion::kNearlyConformal, .max_iterations = 20},
                     X,
                     unused);
}

/// A regular tetrahedron for the four vertices of the coarsest level.
Status place_tetrahedron(const Refinement& refinement, MatrixX3d& X) {
  const MatrixX3i F = refinement.compact_faces();
  std::vector<int> corner;
  for (int v = 0; v < X.rows(); ++v)
    if (!refinement.faces(v).empty()) corner.push_back(v);
  if (corner.size() != 4 || F.rows() != 4)
    return fail(ErrorCode::kNumerical,
                fmt::format("spherical embedding: the coarsest level has {} vertices, not 4",
                            corner.size()));
  X.row(corner[0]) << 1, 1, 1;
  X.row(corner[1]) << 1, -1, -1;
  X.row(corner[2]) << -1, 1, -1;
  X.row(corner[3]) << -1, -1, 1;
  X /= std::sqrt(3.0);
  if (smallest_orientation(F, X) < 0) X.row(corner[0]).swap(X.row(corner[1]));
  if (!(smallest_orientation(F, X) > 0))
    return fail(ErrorCode::kNumerical,
                "spherical embedding: the coarsest level is not a tetrahedron");
  return {};
}

}  // namespace

void relax_worst(const Refinement& level,
                 const MatrixX3d& V,
                 const Lift& lift,
                 const std::vector<int>& pinned,
                 MatrixX3d& X,
                 std::vector<int>& hint) {
  constexpr int kSweeps = 10;
  constexpr double kBound = 40;  // a stretch beyond six in one direction
  const SphereProblem problem = make_sphere_problem(level.compact_faces(), V, pinned);
  Placer placer(level, V, lift, Distortion::kBothWays, X, hint);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int v : vertices_above(problem, lift, kBound, X, hint))
      if (!problem.fixed[at(v)]) placer.place(v, v);
}

Status refine_on_sphere(Refinement& refinement,
                        const MatrixX3d& V,
                        const Lift& lift,
                        const RefineOptions& options,
                        MatrixX3d& X,
                        std::vector<int>& hint) {
  Placer placer(refinement, V, lift, options.optimizer.distortion, X, hint);
  const auto optimise = [&] {
    optimize_on_sphere(make_sphere_problem(refinement.compact_faces(), V, options.pinned),
                       lift,
                       options.optimizer,
                       X,
                       hint);
  };
  // Where a kernel is too thin for doubles its surroundings make room, at last the whole level.
  const auto split = [&] {
    constexpr int kTries = 8, kLocal = 4;
    int v = refinement.split();
    for (int i = 0; i < kTries; ++i) {
      const int kept = refinement.last_kept();
      if (placer.place(v, kept)) return true;
      refinement.collapse(v, kept);
      if (i == kLocal) optimise();
      make_room(refinement, V, kept, options.pinned, X);
      v = refinement.split();
    }
    return placer.place(v, refinement.last_kept());
  };
  int optimised_at = refinement.vertex_count();
  while (!refinement.done() && refinement.vertex_count() < options.until_vertices) {
    if (!split())
      return fail(ErrorCode::kNumerical,
                  fmt::format("spherical embedding: no place beside vertex {} at level {}",
                              refinement.last_kept(),
                              refinement.vertex_count()));
    const int n = refinement.vertex_count();
    const bool last = refinement.done() || n >= options.until_vertices;
    if (!last && n < options.growth * optimised_at) continue;
    optimised_at = n;
    optimise();
  }
  return {};
}

Result<MatrixX3d> embed_in_sphere(const TriangleMesh& mesh, const ProgressiveMesh& progressive) {
  Refinement refinement(progressive);
  MatrixX3d X = MatrixX3d::Zero(mesh.vertex_count(), 3);
  if (Status s = place_tetrahedron(refinement, X); !s) return tl::unexpected(s.error());
  std::vector<int> hint(at(mesh.vertex_count()), 0);
  const RefineOptions options{.until_vertices = mesh.vertex_count(),
                              .growth = 2,
                              .optimizer = {.distortion = Distortion::kNearlyConformal,
                                            .max_iterations = 60,
                                            .relative_decrease = 5e-4,
                                            .barrier = 0.02}};
  if (Status s = refine_on_sphere(refinement, mesh.V, SphereLift(), options, X, hint); !s)
    return tl::unexpected(s.error());
  return X;
}

}  // namespace crosspatch
