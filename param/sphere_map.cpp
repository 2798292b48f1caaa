#include "param/sphere_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "param/cell_relaxation.hpp"
#include "param/congruence.hpp"
#include "param/exact_isometry.hpp"
#include "param/overlay.hpp"
#include "param/sphere_orientation.hpp"
#include "param/sphere_refinement.hpp"
#include "param/unfold.hpp"
#include "param/untangle.hpp"

namespace crosspatch {
namespace {

using std::size_t;

constexpr double kBarrier = 1e-2;

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

PlaceOnMesh place_on(const TriangleMesh& mesh, const SurfacePoint& p) {
  const auto corner = mesh.F.row(p.face);
  return {{corner[0], corner[1], corner[2]}, p.bary};
}

/// Where the embedding `image` has what lies at x in the one of `lift`.
Vector3d carried(const MeshLift& lift,
                 const TriangleMesh& mesh,
                 const MatrixX3d& image,
                 const Vector3d& x,
                 int& face) {
  const SurfacePoint p = lift.surface_point(x, face);
  return (image(mesh.F.row(p.face), Eigen::all).transpose() * p.bary).normalized();
}

void nudge(const TriangleMesh& mesh, int v, int salt, MatrixX3d& X) {
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

}  // namespace

SphereMap::SphereMap(const Shape& source,
                     const Shape& target,
                     const std::vector<Landmark>& landmarks,
                     const MapOptions& options)
    : source_(source),
      target_(target),
      options_(options),
      landmarks_(landmarks),
      level_(source.progressive),
      Y_(target.X),
      lift_(target.mesh, Y_, &target.curvature),
      X_(MatrixX3d::Zero(source.mesh.vertex_count(), 3)),
      hint_(at(source.mesh.vertex_count()), 0) {
  for (const Landmark& l : landmarks) pinned_.push_back(l.source_vertex);
}

Status SphereMap::start(const InitialMap& initial) {
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

double SphereMap::optimize_roughly() {
  constexpr int kIterations = 5;
  relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
  return descend(kIterations);
}

double SphereMap::optimize_coarse() {
  relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
  const double energy = descend(options_.coarse_iterations);
  held_ = Held{level_, X_, pinned_};
  return release() ? descend(options_.coarse_iterations) : energy;
}

double SphereMap::coarse_distortion() const {
  const auto level = mesh_level(source_.mesh, level_);
  if (!level) return std::numeric_limits<double>::infinity();
  const auto mean_log = [](const SphereProblem& problem, const MatrixX3d& Y) {
    double sum = 0;
    for (int f = 0; f < problem.F.rows(); ++f)
      sum += problem.rest_area[f] * std::log(distortion(Distortion::kSymmetricDirichlet,
                                                        problem.rest_inverse[at(f)],
                                                        Y.row(problem.F(f, 0)).transpose(),
                                                        Y.row(problem.F(f, 1)).transpose(),
                                                        Y.row(problem.F(f, 2)).transpose()));
    return sum / problem.rest_area.sum();
  };
  const auto images = [](const std::vector<int>& vertices, const MatrixX3d& X, const Lift& lift) {
    MatrixX3d Y(static_cast<Eigen::Index>(vertices.size()), 3);
    int face = 0;
    for (int i = 0; i < Y.rows(); ++i)
      Y.row(i) = lift.point(X.row(vertices[at(i)]).transpose(), face).transpose();
    return Y;
  };
  const MatrixX3d X = X_(level->vertex, Eigen::all);
  const MeshLift to_source(level->mesh, X);
  const MeshLevel& b = target_.coarse;
  const double there = mean_log(make_sphere_problem(level->mesh.F, level->mesh.V, {}),
                                images(level->vertex, X_, lift_));
  const double back =
      mean_log(make_sphere_problem(b.mesh.F, b.mesh.V, {}), images(b.vertex, Y_, to_source));
  return (there + back) / 2;
}

double SphereMap::coarse_chirality() const {
  const Eigen::MatrixXd &a = source_.chirality, &b = target_.chirality;
  if (a.cols() == 0 || b.cols() != a.cols()) return 0;
  const MeshLevel& coarse = source_.coarse;
  const Eigen::VectorXd areas = face_areas(coarse.mesh);
  Eigen::ArrayXd product = Eigen::ArrayXd::Zero(a.cols()), own = product, other = product;
  int face = 0;
  for (int i = 0; i < coarse.mesh.vertex_count(); ++i) {
    const int v = coarse.vertex[at(i)];
    if (level_.faces(v).empty()) continue;
    double area = 0;
    for_each_outgoing(coarse.mesh, i, [&](int h) { area += areas[h / 3]; });
    const SurfacePoint p = lift_.surface_point(X_.row(v).transpose(), face);
    const Eigen::ArrayXd x = a.row(v).transpose().array();
    Eigen::ArrayXd y = Eigen::ArrayXd::Zero(a.cols());
    for (int k = 0; k < 3; ++k)
      y += p.bary[k] * b.row(target_.mesh.F(p.face, k)).transpose().array();
    product += area * x * y;
    own += area * x.square();
    other += area * y.square();
  }
  const Eigen::ArrayXd size = (own * other).sqrt();
  return (size > 0).select(product / size.max(1e-300), 0.0).mean();
}

std::vector<PlaceOnMesh> SphereMap::coarse_images(const std::vector<int>& vertices) const {
  const MeshLevel level = mesh_level(source_.mesh, level_).value();
  const MatrixX3d own = source_.X(level.vertex, Eigen::all), image = X_(level.vertex, Eigen::all);
  const MeshLift in_level(level.mesh, own);
  std::vector<PlaceOnMesh> places;
  int source_face = 0, target_face = 0;
  for (const int v : vertices) {
    const Vector3d x = level_.faces(v).empty()
                           ? carried(in_level, level.mesh, image, source_.X.row(v), source_face)
                           : Vector3d(X_.row(v));
    places.push_back(place_on(target_.mesh, lift_.surface_point(x, target_face)));
  }
  return places;
}

std::vector<PlaceOnMesh> SphereMap::coarse_preimages(const std::vector<int>& vertices) const {
  const MeshLevel level = mesh_level(source_.mesh, level_).value();
  const MatrixX3d image = X_(level.vertex, Eigen::all);
  const MeshLift to_level(level.mesh, image);
  std::vector<PlaceOnMesh> places;
  int face = 0;
  for (const int v : vertices) {
    PlaceOnMesh place = place_on(level.mesh, to_level.surface_point(Y_.row(v).transpose(), face));
    for (int& w : place.vertex) w = level.vertex[at(w)];
    places.push_back(place);
  }
  return places;
}

double SphereMap::coarse_distance(const SphereMap& other) const {
  double sum = 0;
  int count = 0, face = 0;
  for (const int v : source_.coarse.vertex) {
    if (level_.faces(v).empty() || other.level_.faces(v).empty()) continue;
    const Vector3d y = lift_.point(X_.row(v).transpose(), face);
    sum += (y - other.lift_.point(other.X_.row(v).transpose(), face)).norm();
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

Status SphereMap::refine() {
  if (held_) {
    level_ = std::move(held_->level);
    X_ = std::move(held_->X);
    pinned_ = std::move(held_->pinned);
    held_.reset();
  }
  const Refinement coarse = level_;
  const MatrixX3d places = X_;
  if (!spread_out()) {
    // Too crumpled: vertex by vertex instead, with an optimisation now and then.
    constexpr double kGrowth = 1.4;
    level_ = coarse;
    X_ = places;
    if (Status s = split_back(kGrowth); !s)
      return fail(
          ErrorCode::kNoCorrespondence,
          "map: the full mesh cannot be laid out, do the landmarks contradict each other? (" +
              s.error().message + ")");
  }
  relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
  descend(options_.fine_iterations);
  return {};
}

Status SphereMap::spread_out() {
  const auto level = mesh_level(source_.mesh, level_);
  if (!level) return tl::unexpected(level.error());
  const MatrixX3d own = source_.X(level->vertex, Eigen::all), image = X_(level->vertex, Eigen::all);
  const MeshLift in_level(level->mesh, own);
  int face = 0;
  for (int v = 0; v < source_.mesh.vertex_count(); ++v) {
    if (!level_.faces(v).empty()) continue;
    X_.row(v) = carried(in_level, level->mesh, image, source_.X.row(v), face).transpose();
  }
  level_ = Refinement(full_level(source_.mesh));
  SphereProblem problem = make_sphere_problem(source_.mesh.F, source_.mesh.V, pinned_);
  hold_against_target(problem);
  constexpr double kSeldom = 3;
  return untangle(problem).and_then([&] { return split_back(kSeldom); });
}

Status SphereMap::split_back(double growth) {
  const RefineOptions options{
      .until_vertices = source_.mesh.vertex_count(),
      .pinned = pinned_,
      .growth = growth,
      .optimizer = {.max_iterations = 10, .relative_decrease = 2e-3, .barrier = kBarrier}};
  return refine_on_sphere(level_, source_.mesh.V, lift_, options, X_, hint_);
}

void SphereMap::settle() {
  release();
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
  constexpr int kFew = 12;  // the cells below see more than many steps against the source's kinks
  optimize_on_sphere(problem,
                     to_source,
                     {.max_iterations = kFew, .relative_decrease = 1e-3, .barrier = kBarrier},
                     Y_,
                     hint);
  relax_worst(level_, source_.mesh.V, lift_, pinned_, X_, hint_);
  descend(options_.fine_iterations);
  if (is_nearly_isometric()) {
    const MovingMesh on_source{source_.mesh, pinned_, X_}, on_target{b, pinned, Y_};
    const bool congruent = make_congruent(on_source, on_target);
    const bool target_is_finer = b.vertex_count() >= source_.mesh.vertex_count();
    if (make_exact_isometry(target_is_finer ? on_source : on_target,
                            target_is_finer ? on_target : on_source,
                            options_.fine_iterations) ||
        congruent)
      return;  // the cells below would spoil it
    descend({.max_iterations = options_.fine_iterations, .relative_decrease = 1e-9, .barrier = 0},
            0);
  }
  // What is left is inside faces, where neither side's vertices see it.
  constexpr int kRounds = 8;
  constexpr double kWorthwhile = 5e-3;
  relax_cells({source_.mesh, pinned_, X_}, {b, pinned, Y_}, kRounds, kWorthwhile);
}

bool SphereMap::is_nearly_isometric() {
  // Two triangulations of one surface have 4.0002 to 4.023 by now, bodies in two poses (FAUST,
  // TOSCA) 4.14 and more.
  constexpr double kNearlyIsometric = 4.1;
  return descend({.max_iterations = 0, .barrier = 0}, 0) < kNearlyIsometric;
}

void SphereMap::join_close_vertices() {
  constexpr double kClose = 1e-4;  // of the shortest edge at either: nobody sees such a slip
  const auto shortest = [](const TriangleMesh& mesh, const MatrixX3d& X, int v) {
    double length = 1;
    for_each_outgoing(
        mesh, v, [&](int h) { length = std::min(length, (X.row(v) - X.row(mesh.to(h))).norm()); });
    return length;
  };
  const TriangleMesh &a = source_.mesh, &b = target_.mesh;
  int face = 0;
  for (int v = 0; v < a.vertex_count(); ++v) {
    const Eigen::RowVector3d x = X_.row(v);
    face = lift_.locate(x.transpose(), face);
    int nearest = b.F(face, 0);
    for (int k = 1; k < 3; ++k)
      if ((Y_.row(b.F(face, k)) - x).norm() < (Y_.row(nearest) - x).norm()) nearest = b.F(face, k);
    const double distance = (Y_.row(nearest) - x).norm();
    if (distance == 0 || distance > kClose * std::min(shortest(a, X_, v), shortest(b, Y_, nearest)))
      continue;
    X_.row(v) = Y_.row(nearest);
    bool turns = false;
    for_each_outgoing(a, v, [&](int h) {
      const int f = h / 3;
      turns = turns || !(sphere_orientation(X_.row(a.F(f, 0)).transpose(),
                                            X_.row(a.F(f, 1)).transpose(),
                                            X_.row(a.F(f, 2)).transpose()) > 0);
    });
    if (turns) X_.row(v) = x;
  }
}

Result<SurfaceMap> SphereMap::overlay() {
  join_close_vertices();
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

Status SphereMap::untangle(const SphereProblem& problem) {
  if (unfold(problem, X_) > 0 && !collapse_turned_faces(X_, problem.fixed, level_))
    return fail(ErrorCode::kNoCorrespondence,
                "map: the initial map cannot be untangled on the sphere");
  if (const int d = degree(level_.compact_faces(), X_); d != 1)
    return fail(ErrorCode::kNoCorrespondence,
                fmt::format("map: the initial map covers the target {} times", d));
  return {};
}

bool SphereMap::release() {
  const size_t before = pinned_.size();
  pinned_.clear();
  for (const Landmark& l : landmarks_)
    if (l.pinned) pinned_.push_back(l.source_vertex);
  return pinned_.size() < before;
}

double SphereMap::descend(int iterations) {
  return descend({.max_iterations = iterations, .relative_decrease = 2e-4, .barrier = kBarrier},
                 options_.field_weight);
}

double SphereMap::descend(const SphereOptimizerOptions& options, double field_weight) {
  SphereProblem problem = make_sphere_problem(level_.compact_faces(), source_.mesh.V, pinned_);
  hold_against_target(problem);
  problem.fields = field_weight > 0 ? &source_.curvature : nullptr;
  problem.field_weight = field_weight;
  return optimize_on_sphere(problem, lift_, options, X_, hint_).energy_after;
}

void SphereMap::hold_against_target(SphereProblem& problem) {
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

}  // namespace crosspatch
