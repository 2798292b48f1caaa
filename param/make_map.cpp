#include "param/make_map.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/curvature.hpp"
#include "param/overlay.hpp"
#include "param/sphere_refinement.hpp"
#include "param/unfold.hpp"
#include "param/untangle.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

ProgressiveMesh full_level(const TriangleMesh& mesh) {
  ProgressiveMesh p;
  p.vertex_count = mesh.vertex_count();
  p.coarsest = mesh.F;
  p.alive.assign(at(mesh.face_count()), true);
  return p;
}

/// The source's triangulation on the target's sphere, from the coarsest usable level to the full
/// mesh.
class SphereMap {
 public:
  SphereMap(const Shape& source,
            const Shape& target,
            const std::vector<Landmark>& landmarks,
            const MapOptions& options,
            Eigen::MatrixXd source_fields,
            Eigen::MatrixXd target_fields)
      : source_(source),
        target_(target),
        options_(options),
        source_fields_(std::move(source_fields)),
        target_fields_(std::move(target_fields)),
        level_(source.progressive),
        Y_(target.X),
        lift_(target.mesh, Y_, &target_fields_) {
    X_ = MatrixX3d::Zero(source.mesh.vertex_count(), 3);
    hint_.assign(at(source.mesh.vertex_count()), 0);
    for (const Landmark& l : landmarks) {
      landmarks_.push_back(l);
      pinned_.push_back(l.source_vertex);
    }
  }

  Status start(const InitialMap& initial) {
    const MeshLevel &a = source_.coarse, &b = target_.coarse;
    const MatrixX3d on_target =
        to_disc(initial.target_disc, MatrixX3d(target_.X(b.vertex, Eigen::all)));
    const MatrixX3d image = through_disc(initial.source_disc, initial.target_disc, on_target);
    for (int i = 0; i < a.mesh.vertex_count(); ++i)
      X_.row(a.vertex[at(i)]) = image.row(initial.source_disc.disc_vertex[at(i)]).normalized();
    for (const Landmark& l : landmarks_) X_.row(l.source_vertex) = Y_.row(l.target_vertex);
    while (level_.vertex_count() < a.mesh.vertex_count()) level_.split();
    SphereProblem problem = make_sphere_problem(level_.compact_faces(), source_.mesh.V, pinned_);
    hold_against_target(problem);
    if (Status s = untangle(problem); !s) return s;
    if (level_.vertex_count() == a.mesh.vertex_count()) smooth_on_sphere(problem, X_);
    return {};
  }

  void optimize_coarse() {
    relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
    descend(options_.coarse_iterations);
    relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
    descend(options_.coarse_iterations);
    if (release()) {
      descend(options_.coarse_iterations);
    }
  }

  /// Goes to the full mesh. Its vertices lie in the level's faces in the source's own embedding,
  /// and keep their places in them; what turns over by that is unfolded.
  Status refine() {
    const auto level = mesh_level(source_.mesh, level_);
    if (!level) return tl::unexpected(level.error());
    const MatrixX3d own = source_.X(level->vertex, Eigen::all),
                    image = X_(level->vertex, Eigen::all);
    const MeshLift in_level(level->mesh, own);
    int face = 0;
    for (int v = 0; v < source_.mesh.vertex_count(); ++v) {
      if (!level_.faces(v).empty()) continue;
      const SurfacePoint p = in_level.surface_point(source_.X.row(v).transpose(), face);
      Vector3d x = Vector3d::Zero();
      for (int k = 0; k < 3; ++k) x += p.bary[k] * image.row(level->mesh.F(p.face, k)).transpose();
      X_.row(v) = x.normalized().transpose();
    }
    level_ = Refinement(full_level(source_.mesh));
    SphereProblem problem = make_sphere_problem(source_.mesh.F, source_.mesh.V, pinned_);
    hold_against_target(problem);
    if (Status s = untangle(problem); !s) return s;
    const RefineOptions options{
        .until_vertices = source_.mesh.vertex_count(),
        .pinned = pinned_,
        .optimizer = {.max_iterations = 10, .relative_decrease = 2e-3, .barrier = kBarrier}};
    if (Status s = refine_on_sphere(level_, source_.mesh.V, lift_, options, X_, hint_); !s)
      return s;
    relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
    descend(options_.fine_iterations);
    return {};
  }

  /// Lets the target's vertices move under the same energy of the inverse map, and then the
  /// source's again: each side only sees what happens at its own vertices.
  void settle() {
    const TriangleMesh& b = target_.mesh;
    std::vector<int> pinned;
    for (const Landmark& l : landmarks_)
      if (l.pinned) pinned.push_back(l.target_vertex);
    const MeshLift to_source(source_.mesh, X_);
    std::vector<int> hint(at(b.vertex_count()), 0);
    relax_worst(Refinement(full_level(b)), b.V, to_source, pinned, Y_, hint);
    SphereProblem problem = make_sphere_problem(b.F, b.V, pinned);
    for (int f = 0; f < b.face_count(); ++f) {
      const Vector3d x0 = Y_.row(b.F(f, 0)), x1 = Y_.row(b.F(f, 1)), x2 = Y_.row(b.F(f, 2));
      problem.reference_orientation[f] = x0.dot((x1 - x0).cross(x2 - x0));
    }
    optimize_on_sphere(problem,
                       to_source,
                       {.max_iterations = options_.fine_iterations,
                        .relative_decrease = 1e-3,
                        .barrier = kBarrier},
                       Y_,
                       hint);
    relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
    descend(options_.fine_iterations);
  }

  /// The common subdivision; vertices in special position are moved by a billionth of their edges.
  Result<SurfaceMap> overlay() {
    MatrixX3d& Y = Y_;
    constexpr int kTries = 100;
    Result<SurfaceMap> map = fail(ErrorCode::kInternal, "overlay: not tried");
    for (int i = 0; i < kTries; ++i) {
      SpecialPosition special;
      map = overlay_on_sphere(source_.mesh, X_, target_.mesh, Y, &special);
      if (map || special.vertex < 0) return map;
      nudge(special.on_source ? source_.mesh : target_.mesh,
            special.vertex,
            i,
            special.on_source ? X_ : Y);
    }
    return map;
  }

 private:
  static constexpr double kBarrier = 1e-2;

  static void nudge(const TriangleMesh& mesh, int v, int salt, MatrixX3d& X) {
    double shortest = 1;
    for_each_outgoing(mesh, v, [&](int h) {
      shortest = std::min(shortest, (X.row(v) - X.row(mesh.to(h))).norm());
    });
    const double angle = 1 + 2.4 * salt;  // successive tries go different ways
    const Vector3d x = X.row(v).transpose(), e = x.unitOrthogonal();
    X.row(v) = (x + 1e-9 * shortest * (std::cos(angle) * e + std::sin(angle) * x.cross(e)))
                   .normalized()
                   .transpose();
  }

  /// Turns faces back, and where that does not help collapses vertices of the level.
  Status untangle(const SphereProblem& problem) {
    if (unfold(problem, X_) > 0 && !collapse_turned_faces(X_, problem.fixed, level_))
      return fail(ErrorCode::kNoCorrespondence,
                  "map: the initial map cannot be untangled on the sphere");
    if (const int d = degree(level_.compact_faces(), X_); d != 1)
      return fail(ErrorCode::kNoCorrespondence,
                  fmt::format("map: the initial map covers the target {} times", d));
    return {};
  }

  /// Lets go of the landmarks that only decided the homotopy class. True if there were any.
  bool release() {
    const size_t before = pinned_.size();
    pinned_.clear();
    for (const Landmark& l : landmarks_)
      if (l.pinned) pinned_.push_back(l.source_vertex);
    return pinned_.size() < before;
  }

  void descend(int iterations) {
    SphereProblem problem = make_sphere_problem(level_.compact_faces(), source_.mesh.V, pinned_);
    hold_against_target(problem);
    problem.fields = &source_fields_;
    problem.field_weight = options_.field_weight;
    optimize_on_sphere(
        problem,
        lift_,
        {.max_iterations = iterations, .relative_decrease = 2e-4, .barrier = kBarrier},
        X_,
        hint_);
  }

  /// A face that lies where the target is packed densely on the sphere may be as small as that.
  void hold_against_target(SphereProblem& problem) {
    const TriangleMesh& b = target_.mesh;
    for (int f = 0; f < problem.F.rows(); ++f) {
      double density = 0;
      for (int k = 0; k < 3; ++k) {
        const int v = problem.F(f, k);
        lift_.point(X_.row(v).transpose(), hint_[at(v)]);
        const int g = hint_[at(v)];
        const Vector3d x0 = Y_.row(b.F(g, 0)), x1 = Y_.row(b.F(g, 1)), x2 = Y_.row(b.F(g, 2));
        const Vector3d y0 = b.position(b.F(g, 0)), y1 = b.position(b.F(g, 1)),
                       y2 = b.position(b.F(g, 2));
        density += std::log(x0.dot((x1 - x0).cross(x2 - x0)) /
                            std::max((y1 - y0).cross(y2 - y0).norm(), 1e-14)) /
                   3;
      }
      problem.reference_orientation[f] = 2 * problem.rest_area[f] * std::exp(density);
    }
  }

  const Shape& source_;
  const Shape& target_;
  const MapOptions& options_;
  const Eigen::MatrixXd source_fields_, target_fields_;  ///< curvatures
  Refinement level_;
  MatrixX3d Y_;  ///< the target's embedding
  MeshLift lift_;
  MatrixX3d X_;
  std::vector<int> hint_;
  std::vector<Landmark> landmarks_;
  std::vector<int> pinned_;  ///< source vertices that may not move
};

}  // namespace

Result<MapResult> optimize_map(const Shape& source,
                               const Shape& target,
                               const InitialMap& initial,
                               const std::vector<Landmark>& landmarks,
                               const MapOptions& options) {
  Result<Eigen::MatrixXd> fields[2] = {Eigen::MatrixXd(), Eigen::MatrixXd()};
  tbb::parallel_for(
      0, 2, [&](int i) { fields[i] = curvature_fields(i == 0 ? source.mesh : target.mesh); });
  for (const auto& field : fields)
    if (!field) return tl::unexpected(field.error());
  SphereMap sphere(
      source, target, landmarks, options, std::move(*fields[0]), std::move(*fields[1]));
  if (Status s = sphere.start(initial); !s) return tl::unexpected(s.error());
  sphere.optimize_coarse();
  if (Status s = sphere.refine(); !s) return tl::unexpected(s.error());
  sphere.settle();
  auto map = sphere.overlay();
  if (!map) return tl::unexpected(map.error());
  MapResult result{std::move(*map), {}, initial.distortion};
  result.quality = measure_map(result.map, source.mesh, target.mesh);
  return result;
}

}  // namespace crosspatch
