#include "param/make_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "param/overlay.hpp"
#include "param/sphere_refinement.hpp"
#include "param/untangle.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Lengths of shortest edge paths from `start`.
std::vector<double> edge_distances(const TriangleMesh& mesh, int start) {
  std::vector<double> distance(at(mesh.vertex_count()), std::numeric_limits<double>::infinity());
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
      queue;
  distance[at(start)] = 0;
  queue.emplace(0.0, start);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[at(v)]) continue;
    for_each_outgoing(mesh, v, [&, from = v, base = d](int h) {
      const int w = mesh.to(h);
      const double through = base + (mesh.position(from) - mesh.position(w)).norm();
      if (through < distance[at(w)]) {
        distance[at(w)] = through;
        queue.emplace(through, w);
      }
    });
  }
  return distance;
}

std::vector<int> level_vertices(const MeshLevel& level, const std::vector<int>& vertices) {
  std::vector<int> found;
  for (int v : vertices) {
    const auto it = std::lower_bound(level.vertex.begin(), level.vertex.end(), v);
    found.push_back(
        it != level.vertex.end() && *it == v ? static_cast<int>(it - level.vertex.begin()) : -1);
  }
  return found;
}

/// The shortest open chains through all points, given their distances (symmetric k x k): every one
/// for up to 7 points, else nearest-neighbour chains from each start, improved by reversals.
std::vector<std::vector<int>> shortest_chains(const Eigen::MatrixXd& D, int count) {
  const int k = static_cast<int>(D.rows());
  const auto length = [&](const std::vector<int>& c) {
    double sum = 0;
    for (size_t i = 0; i + 1 < c.size(); ++i) sum += D(c[i], c[i + 1]);
    return sum;
  };
  std::vector<std::pair<double, std::vector<int>>> chains;
  std::vector<int> chain(at(k));
  std::iota(chain.begin(), chain.end(), 0);
  constexpr int kAll = 7;
  if (k <= kAll) {
    do {
      if (chain.front() < chain.back()) chains.emplace_back(length(chain), chain);
    } while (std::next_permutation(chain.begin(), chain.end()));
  } else {
    for (int start = 0; start < k; ++start) {
      std::iota(chain.begin(), chain.end(), 0);
      std::swap(chain[0], chain[at(start)]);
      for (size_t i = 1; i < chain.size(); ++i)
        std::iter_swap(chain.begin() + static_cast<std::ptrdiff_t>(i),
                       std::min_element(
                           chain.begin() + static_cast<std::ptrdiff_t>(i),
                           chain.end(),
                           [&](int a, int b) { return D(chain[i - 1], a) < D(chain[i - 1], b); }));
      for (bool better = true; better;) {
        better = false;
        for (size_t i = 0; i < chain.size(); ++i)
          for (size_t j = i + 2; j <= chain.size(); ++j) {
            std::vector<int> trial = chain;
            std::reverse(trial.begin() + static_cast<std::ptrdiff_t>(i),
                         trial.begin() + static_cast<std::ptrdiff_t>(j));
            if (length(trial) < length(chain) - 1e-12) {
              chain = std::move(trial);
              better = true;
            }
          }
      }
      if (chain.front() > chain.back()) std::reverse(chain.begin(), chain.end());
      chains.emplace_back(length(chain), chain);
    }
  }
  std::sort(chains.begin(), chains.end());
  chains.erase(std::unique(chains.begin(), chains.end()), chains.end());
  std::vector<std::vector<int>> best;
  for (const auto& c : chains)
    if (static_cast<int>(best.size()) < count) best.push_back(c.second);
  return best;
}

/// The source's triangulation on the target's sphere, from the coarsest usable level to the full
/// mesh.
class SphereMap {
 public:
  SphereMap(const Shape& source,
            const Shape& target,
            const std::vector<Landmark>& landmarks,
            const MapOptions& options)
      : source_(source),
        target_(target),
        options_(options),
        level_(source.progressive),
        exact_(target.mesh, target.X, 0),
        smooth_(target.mesh, target.X, 3) {
    X_ = MatrixX3d::Zero(source.mesh.vertex_count(), 3);
    hint_.assign(at(source.mesh.vertex_count()), 0);
    fixed_.assign(hint_.size(), false);
    for (const Landmark& l : landmarks) {
      pinned_.push_back(l.source_vertex);
      pinned_to_.push_back(l.target_vertex);
      fixed_[at(l.source_vertex)] = true;
    }
  }

  Status start(const InitialMap& initial) {
    const MeshLevel &a = source_.coarse, &b = target_.coarse;
    const MatrixX3d on_target =
        to_disc(initial.target_disc, MatrixX3d(target_.X(b.vertex, Eigen::all)));
    const MatrixX3d image = through_disc(initial.source_disc, initial.target_disc, on_target);
    for (int i = 0; i < a.mesh.vertex_count(); ++i)
      X_.row(a.vertex[at(i)]) = image.row(initial.source_disc.disc_vertex[at(i)]).normalized();
    for (size_t i = 0; i < pinned_.size(); ++i) X_.row(pinned_[i]) = target_.X.row(pinned_to_[i]);
    while (level_.vertex_count() < a.mesh.vertex_count()) level_.split();
    if (!collapse_turned_faces(X_, fixed_, level_))
      return fail(ErrorCode::kNoCorrespondence,
                  "map: the initial map cannot be untangled on the sphere");
    return {};
  }

  void optimize_coarse() {
    relax_worst(level_, source_.mesh.V, exact_, pinned_, X_, hint_);
    descend(smooth_, true, options_.coarse_iterations);
    relax_worst(level_, source_.mesh.V, exact_, pinned_, X_, hint_);
    descend(exact_, true, options_.coarse_iterations);
    relax_worst(level_, source_.mesh.V, exact_, pinned_, X_, hint_);
    descend(smooth_, false, options_.coarse_iterations);
    descend(exact_, false, options_.coarse_iterations);
  }

  Status refine() {
    const RefineOptions options{
        .until_vertices = source_.mesh.vertex_count(),
        .pinned = pinned_,
        .growth = 3,
        .optimizer = {.max_iterations = 20, .relative_decrease = 1e-3, .barrier = kBarrier}};
    if (Status s = refine_on_sphere(level_, source_.mesh.V, exact_, options, X_, hint_); !s)
      return s;
    relax_worst(level_, source_.mesh.V, exact_, pinned_, X_, hint_);
    descend(exact_, false, options_.fine_iterations);
    return {};
  }

  /// The common subdivision; vertices in special position are moved by a billionth of their edges.
  Result<SurfaceMap> overlay() {
    MatrixX3d Y = target_.X;
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

  void descend(const MeshLift& lift, bool logarithmic, int iterations) {
    SphereProblem problem = make_sphere_problem(level_.compact_faces(), source_.mesh.V, pinned_);
    hold_against_target(problem);
    optimize_on_sphere(problem,
                       lift,
                       {.max_iterations = iterations,
                        .relative_decrease = 1e-4,
                        .logarithmic = logarithmic,
                        .barrier = kBarrier},
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
        exact_.point(X_.row(v).transpose(), hint_[at(v)]);
        const int g = hint_[at(v)];
        const Vector3d x0 = target_.X.row(b.F(g, 0)), x1 = target_.X.row(b.F(g, 1)),
                       x2 = target_.X.row(b.F(g, 2));
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
  Refinement level_;
  MeshLift exact_, smooth_;
  MatrixX3d X_;
  std::vector<int> hint_;
  std::vector<bool> fixed_;
  std::vector<int> pinned_, pinned_to_;
};

}  // namespace

Result<InitialMap> initial_map(const Shape& source,
                               const Shape& target,
                               const std::vector<Landmark>& landmarks,
                               int chains) {
  std::vector<int> a, b;
  for (const Landmark& l : landmarks) {
    a.push_back(l.source_vertex);
    b.push_back(l.target_vertex);
  }
  a = level_vertices(source.coarse, a);
  b = level_vertices(target.coarse, b);
  if (a.size() < 2)
    return fail(ErrorCode::kNoCorrespondence,
                fmt::format("map: {} landmarks, at least 2 are needed", a.size()));
  Eigen::MatrixXd D(landmarks.size(), landmarks.size());
  for (int i = 0; i < D.rows(); ++i) {
    const auto da = edge_distances(source.coarse.mesh, a[at(i)]),
               db = edge_distances(target.coarse.mesh, b[at(i)]);
    for (int j = 0; j < D.cols(); ++j) D(i, j) = da[at(a[at(j)])] + db[at(b[at(j)])];
  }
  Result<InitialMap> best =
      fail(ErrorCode::kNoCorrespondence, "map: no chain of paths through the landmarks can be cut");
  for (const std::vector<int>& order : shortest_chains(D, chains)) {
    std::vector<int> chain_a, chain_b;
    for (int i : order) {
      chain_a.push_back(a[at(i)]);
      chain_b.push_back(b[at(i)]);
    }
    auto da = cut_along_chain(source.coarse.mesh, chain_a);
    if (!da) continue;
    auto db = cut_along_chain(target.coarse.mesh, chain_b);
    if (!db) continue;
    const double distortion = disc_distortion(*da, *db);
    if (!best || distortion < best->distortion)
      best = InitialMap{std::move(*da), std::move(*db), distortion};
  }
  return best;
}

Result<MapResult> optimize_map(const Shape& source,
                               const Shape& target,
                               const InitialMap& initial,
                               const std::vector<Landmark>& landmarks,
                               const MapOptions& options) {
  SphereMap sphere(source, target, landmarks, options);
  if (Status s = sphere.start(initial); !s) return tl::unexpected(s.error());
  sphere.optimize_coarse();
  if (Status s = sphere.refine(); !s) return tl::unexpected(s.error());
  auto map = sphere.overlay();
  if (!map) return tl::unexpected(map.error());
  MapResult result{std::move(*map), {}, initial.distortion};
  result.quality = measure_map(result.map, source.mesh, target.mesh);
  return result;
}

}  // namespace crosspatch
