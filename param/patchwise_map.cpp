// The rectangle lies in the plane z = 1; an apex at (0, 0, -1) joined to its rim closes it to a
// sphere under central projection, so that the exact overlay of spheres serves discs as well.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/index.hpp"
#include "param/overlay.hpp"
#include "param/patches.hpp"
#include "param/predicates.hpp"

namespace crosspatch {
namespace {

using std::size_t;

struct Closed {
  TriangleMesh mesh;
  MatrixX3d X;
};

Closed close_disc(const PatchDisc& disc, const MatrixX2d& uv) {
  const int n = disc.mesh.vertex_count(), rim = static_cast<int>(disc.loop.size());
  MatrixX3i F(disc.mesh.face_count() + rim, 3);
  F.topRows(disc.mesh.face_count()) = disc.mesh.F;
  for (int i = 0; i < rim; ++i)
    F.row(disc.mesh.face_count() + i) << disc.loop[idx((i + 1) % rim)], disc.loop[idx(i)], n;
  MatrixX3d X(n + 1, 3);
  X.topLeftCorner(n, 2) = uv;
  X.col(2).head(n).setOnes();
  X.row(n) << 0, 0, -1;
  return {make_mesh(X, F).value(), X};
}

/// Moves an inner vertex a little, its triangles staying positive; false if it cannot move.
bool nudge(Closed& closed, int vertex, int attempt) {
  if (closed.X(vertex, 2) < 0) return false;
  const TriangleMesh& mesh = closed.mesh;
  double shortest = HUGE_VAL;
  for_each_outgoing(mesh, vertex, [&](int h) {
    shortest = std::min(shortest, (closed.X.row(mesh.to(h)) - closed.X.row(vertex)).norm());
  });
  const Vector3d before = closed.X.row(vertex);
  // Directions by the golden angle, so that attempts do not repeat one.
  const double angle = 2.399963 * attempt;
  for (double step = 1e-6 * shortest; step > 1e-13 * shortest; step /= 4) {
    closed.X.row(vertex) = before + step * Vector3d(std::cos(angle), std::sin(angle), 0);
    bool positive = true;
    for_each_outgoing(mesh, vertex, [&](int h) {
      positive = positive &&
                 orient_sphere(
                     closed.X.row(vertex), closed.X.row(mesh.to(h)), closed.X.row(mesh.tip(h))) > 0;
    });
    if (positive) return true;
  }
  closed.X.row(vertex) = before;
  return false;
}

bool on_rim(const PatchDisc& disc, int vertex) {
  return std::find(disc.loop.begin(), disc.loop.end(), vertex) != disc.loop.end() ||
         vertex == disc.mesh.vertex_count();
}

/// Puts the apex below a place of the rectangle that symmetric rims do not have in line with two of
/// their vertices; another place with each attempt.
void place_apex(Closed& closed, int attempt) {
  const double angle = 1 + 2.399963 * attempt;
  closed.X.bottomRows(1) << 0.1234567 * std::cos(angle), 0.1234567 * std::sin(angle), -1;
}

Result<SurfaceMap> overlay_patch(const PatchPair& pair, int face) {
  Closed a = close_disc(pair.source, pair.source_chart.uv);
  Closed b = close_disc(pair.target, pair.target_chart.uv);
  constexpr int kAttempts = 500;
  std::string why;
  place_apex(a, 0);
  place_apex(b, 0);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    SpecialPosition special;
    auto map = overlay_on_sphere(a.mesh, a.X, b.mesh, b.X, &special);
    if (map) return map;
    why = map.error().message;
    if (special.vertex < 0) break;
    if (on_rim(special.on_source ? pair.source : pair.target, special.vertex)) {
      place_apex(a, attempt + 1);
      place_apex(b, attempt + 1);
    } else if (!nudge(special.on_source ? a : b, special.vertex, attempt)) {
      break;
    }
  }
  return fail(ErrorCode::kNumerical, fmt::format("patch {}: {}", face, why));
}

/// A point of the closed disc on the drawn mesh. Faces of the rim's cone hold rim vertices only.
SurfacePoint on_drawn(const PatchDisc& disc,
                      const TriangleMesh& drawn,
                      const TriangleMesh& closed,
                      const SurfacePoint& p) {
  for (int k = 0; k < 3; ++k)
    if (p.bary[k] == 1) return disc.origin[idx(closed.F(p.face, k))];
  if (p.face >= disc.mesh.face_count()) return {};
  SurfacePoint q{disc.parent_face[idx(p.face)], Vector3d::Zero()};
  for (int k = 0; k < 3; ++k)
    q.bary += p.bary[k] * in_face(drawn, disc.origin[idx(closed.F(p.face, k))], q.face).bary;
  return q;
}

/// Collects the overlays of the patches; points on arcs are shared, known by arc and share.
class Gathering {
 public:
  Gathering(const DrawnLayout& source, const DrawnLayout& target)
      : source_(source), target_(target) {
    map_.point_of_source_vertex.assign(idx(source.mesh.vertex_count()), -1);
    map_.point_of_target_vertex.assign(idx(target.mesh.vertex_count()), -1);
  }

  void add(const PatchPair& pair, int face, const SurfaceMap& overlay);
  SurfaceMap take() { return std::move(map_); }

 private:
  using RimKey = std::pair<int, double>;  ///< arc and share, or -1 - node and 0

  [[nodiscard]] RimKey rim_key(int dart, double share) const {
    if (share == 0) return {-1 - source_.layout.node[idx(dart & ~1)], 0};
    if (share == 1) return {-1 - source_.layout.node[idx(dart | 1)], 0};
    return {dart / 2, share};
  }
  int new_point(const SurfacePoint& source, const SurfacePoint& target) {
    map_.source.push_back(source);
    map_.target.push_back(target);
    return map_.point_count() - 1;
  }

  const DrawnLayout& source_;
  const DrawnLayout& target_;
  SurfaceMap map_;
  std::map<RimKey, int> rim_;
};

void Gathering::add(const PatchPair& pair, int face, const SurfaceMap& overlay) {
  const std::vector<int> darts = darts_of_face(source_.layout, face);
  std::vector<int> name(idx(overlay.point_count()), -1);
  for (size_t i = 0; i < pair.source.loop.size(); ++i) {
    const int a = pair.source.loop[i], b = pair.target.loop[i];
    const RimKey key = rim_key(darts[idx(pair.source.side[i])], pair.source.share[i]);
    const auto [at, fresh] = rim_.try_emplace(key, -1);
    if (fresh) at->second = new_point(pair.source.origin[idx(a)], pair.target.origin[idx(b)]);
    name[idx(overlay.point_of_source_vertex[idx(a)])] = at->second;
  }
  const TriangleMesh a = close_disc(pair.source, pair.source_chart.uv).mesh;
  const TriangleMesh b = close_disc(pair.target, pair.target_chart.uv).mesh;
  for (int p = 0; p < overlay.polygon_count(); ++p) {
    if (overlay.source_face[idx(p)] >= pair.source.mesh.face_count()) continue;
    for (int i = overlay.polygon_begin[idx(p)]; i < overlay.polygon_begin[idx(p) + 1]; ++i) {
      const int q = overlay.corner[idx(i)];
      int& global = name[idx(q)];
      if (global < 0)
        global = new_point(on_drawn(pair.source, source_.mesh, a, overlay.source[idx(q)]),
                           on_drawn(pair.target, target_.mesh, b, overlay.target[idx(q)]));
      map_.corner.push_back(global);
    }
    map_.polygon_begin.push_back(static_cast<int>(map_.corner.size()));
    map_.source_face.push_back(pair.source.parent_face[idx(overlay.source_face[idx(p)])]);
    map_.target_face.push_back(pair.target.parent_face[idx(overlay.target_face[idx(p)])]);
  }
  for (size_t v = 0; v < pair.source.vertex.size(); ++v)
    if (pair.source.vertex[v] >= 0)
      map_.point_of_source_vertex[idx(pair.source.vertex[v])] =
          name[idx(overlay.point_of_source_vertex[v])];
  for (size_t v = 0; v < pair.target.vertex.size(); ++v)
    if (pair.target.vertex[v] >= 0)
      map_.point_of_target_vertex[idx(pair.target.vertex[v])] =
          name[idx(overlay.point_of_target_vertex[v])];
}

SurfacePoint on_given(const SurfacePoint& p, const DrawnLayout& drawn, const TriangleMesh& given) {
  SurfacePoint q{drawn.parent_face[idx(p.face)], Vector3d::Zero()};
  for (int k = 0; k < 3; ++k)
    q.bary += p.bary[k] * in_face(given, drawn.origin[idx(drawn.mesh.F(p.face, k))], q.face).bary;
  return q;
}

}  // namespace

Result<SurfaceMap> patchwise_map(const DrawnLayout& source,
                                 const DrawnLayout& target,
                                 const std::vector<PatchPair>& patches) {
  std::vector<Result<SurfaceMap>> overlays(patches.size());
  tbb::parallel_for(size_t{0}, patches.size(), [&](size_t f) {
    overlays[f] = overlay_patch(patches[f], static_cast<int>(f));
  });
  Gathering gathering(source, target);
  for (size_t f = 0; f < patches.size(); ++f) {
    if (!overlays[f]) return tl::unexpected(overlays[f].error());
    gathering.add(patches[f], static_cast<int>(f), *overlays[f]);
  }
  return gathering.take();
}

SurfaceMap on_given_meshes(const SurfaceMap& map,
                           const DrawnLayout& source,
                           const TriangleMesh& given_source,
                           const DrawnLayout& target,
                           const TriangleMesh& given_target) {
  SurfaceMap r = map;
  for (SurfacePoint& p : r.source) p = on_given(p, source, given_source);
  for (SurfacePoint& p : r.target) p = on_given(p, target, given_target);
  for (int& f : r.source_face) f = source.parent_face[idx(f)];
  for (int& f : r.target_face) f = target.parent_face[idx(f)];
  r.point_of_source_vertex.resize(idx(given_source.vertex_count()));
  r.point_of_target_vertex.resize(idx(given_target.vertex_count()));
  return r;
}

}  // namespace crosspatch
