#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <map>
#include <utility>

#include "core/index.hpp"
#include "param/disc_overlay.hpp"
#include "param/patches.hpp"

namespace crosspatch {
namespace {

using std::size_t;

Result<SurfaceMap> overlay_patch(const PatchPair& pair, int face) {
  return overlay_discs({pair.source.mesh, pair.source_chart.uv, pair.source.loop},
                       {pair.target.mesh, pair.target_chart.uv, pair.target.loop})
      .map_error([&](Error e) {
        e.message = fmt::format("patch {}: {}", face, e.message);
        return e;
      });
}

SurfacePoint on_drawn(const PatchDisc& disc, const TriangleMesh& drawn, const SurfacePoint& p) {
  return on_parent(disc.mesh, disc.origin, disc.parent_face, drawn, p);
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
  for (int p = 0; p < overlay.polygon_count(); ++p) {
    for (int i = overlay.polygon_begin[idx(p)]; i < overlay.polygon_begin[idx(p) + 1]; ++i) {
      const int q = overlay.corner[idx(i)];
      int& global = name[idx(q)];
      if (global < 0)
        global = new_point(on_drawn(pair.source, source_.mesh, overlay.source[idx(q)]),
                           on_drawn(pair.target, target_.mesh, overlay.target[idx(q)]));
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
