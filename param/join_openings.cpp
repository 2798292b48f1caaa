#include "param/join_openings.hpp"

#include <algorithm>
#include <map>

#include "core/index.hpp"
#include "param/cap_regions.hpp"
#include "param/collar.hpp"
#include "param/disc_overlay.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// The openings that are joined by one collar: caps of the source with their partners.
struct Opening {
  std::vector<int> caps;
  std::vector<int> region;  ///< polygons of the closed map
};

/// Handles and holes whose caps all have regions, with their polygons.
std::vector<Opening> find_openings(const CappedSurface& source,
                                   const std::vector<std::vector<int>>& regions) {
  std::vector<Opening> openings;
  std::map<int, size_t> of_handle;
  for (size_t i = 0; i < regions.size(); ++i) {
    if (regions[i].empty()) continue;
    const int handle = source.caps[i].handle;
    size_t at = openings.size();
    if (handle >= 0) at = of_handle.try_emplace(handle, at).first->second;
    if (at == openings.size()) openings.emplace_back();
    openings[at].caps.push_back(static_cast<int>(i));
    openings[at].region.insert(openings[at].region.end(), regions[i].begin(), regions[i].end());
  }
  std::erase_if(openings, [&](const Opening& o) {
    return source.caps[idx(o.caps[0])].handle >= 0 && o.caps.size() != 2;
  });
  return openings;
}

struct Joint {
  Opening opening;
  Collar collar;
};

bool is_handle(const CappedSurface& source, const Joint& joint) {
  return source.caps[idx(joint.opening.caps[0])].handle >= 0;
}

size_t cap_count(const std::vector<Joint>& joints) {
  size_t count = 0;
  for (const Joint& joint : joints) count += joint.opening.caps.size();
  return count;
}

/// Counts what the joints leave open.
void count_left(const CappedSurface& source,
                const CappedSurface& target,
                const std::vector<Joint>& joints,
                JoinedMap& result) {
  int handles = 0, holes = 0;
  for (const Joint& joint : joints) (is_handle(source, joint) ? handles : holes) += 1;
  for (const size_t s : {0U, 1U}) {
    const CappedSurface& surface = s == 0 ? source : target;
    result.handles[s] = static_cast<int>(surface.cut.loops.size()) - handles;
    result.holes[s] = surface.holes - holes;
  }
}

/// Puts collars and the rest of a map together.
class Assembly {
 public:
  Assembly(const SurfaceMap& closed,
           const TriangleMesh& source,
           const CappedSurface& capped_source,
           const TriangleMesh& target,
           const CappedSurface& capped_target)
      : closed_(closed),
        sides_{Side{source, capped_source, closed.point_of_source_vertex},
               Side{target, capped_target, closed.point_of_target_vertex}},
        kept_(closed.source.size(), -1) {
    map_.point_of_source_vertex.assign(idx(source.vertex_count()), -1);
    map_.point_of_target_vertex.assign(idx(target.vertex_count()), -1);
  }

  /// The polygons outside the regions of collars, as far as they lie on no cap.
  void add_rest(const std::vector<Joint>& joints) {
    std::vector<bool> in_collar(idx(closed_.polygon_count()), false);
    for (const Joint& joint : joints)
      for (const int p : joint.opening.region) in_collar[idx(p)] = true;
    for (int p = 0; p < closed_.polygon_count(); ++p) {
      const int fa = closed_.source_face[idx(p)], fb = closed_.target_face[idx(p)];
      if (in_collar[idx(p)] || fa >= sides_[0].capped.filled.face_count ||
          fb >= sides_[1].capped.filled.face_count)
        continue;
      for (int i = closed_.polygon_begin[idx(p)]; i < closed_.polygon_begin[idx(p) + 1]; ++i) {
        const int q = closed_.corner[idx(i)];
        if (kept_[idx(q)] < 0)
          kept_[idx(q)] =
              new_point(in_face(sides_[0].capped.filled.mesh, closed_.source[idx(q)], fa),
                        in_face(sides_[1].capped.filled.mesh, closed_.target[idx(q)], fb));
        map_.corner.push_back(kept_[idx(q)]);
      }
      end_polygon(fa, fb);
    }
    for (const auto s : {0, 1}) {
      auto& point_of = s == 0 ? map_.point_of_source_vertex : map_.point_of_target_vertex;
      for (size_t v = 0; v < point_of.size(); ++v)
        point_of[v] = kept_[idx(sides_[idx(s)].point_of_vertex[v])];
    }
  }

  void add(const Collar& collar) {
    const Piece &a = collar.source.disc, &b = collar.target.disc;
    std::vector<int> name(collar.map.source.size(), -1);
    std::map<int, int> cut_points;  // by key; below zero are those of the collar's own
    for (size_t i = 0; i < collar.source.loop.size(); ++i) {
      const int key = collar.source.loop_key[i];
      int& global = key >= 0 ? kept_[idx(key)] : cut_points.try_emplace(key, -1).first->second;
      if (global < 0)
        global =
            new_point(a.origin[idx(collar.source.loop[i])], b.origin[idx(collar.target.loop[i])]);
      name[idx(collar.map.point_of_source_vertex[idx(collar.source.loop[i])])] = global;
    }
    for (int p = 0; p < collar.map.polygon_count(); ++p) {
      for (int i = collar.map.polygon_begin[idx(p)]; i < collar.map.polygon_begin[idx(p) + 1];
           ++i) {
        const int q = collar.map.corner[idx(i)];
        if (name[idx(q)] < 0)
          name[idx(q)] = new_point(
              on_parent(
                  a.mesh, a.origin, a.parent_face, sides_[0].given, collar.map.source[idx(q)]),
              on_parent(
                  b.mesh, b.origin, b.parent_face, sides_[1].given, collar.map.target[idx(q)]));
        map_.corner.push_back(name[idx(q)]);
      }
      end_polygon(a.parent_face[idx(collar.map.source_face[idx(p)])],
                  b.parent_face[idx(collar.map.target_face[idx(p)])]);
    }
    name_vertices(
        sides_[0], a, collar.map.point_of_source_vertex, name, map_.point_of_source_vertex);
    name_vertices(
        sides_[1], b, collar.map.point_of_target_vertex, name, map_.point_of_target_vertex);
  }

  SurfaceMap take() { return std::move(map_); }

 private:
  struct Side {
    const TriangleMesh& given;
    const CappedSurface& capped;
    const std::vector<int>& point_of_vertex;  ///< of the filled mesh
    std::vector<int> vertex_at = {};          ///< per point: the given surface's vertex, or -1

    Side(const TriangleMesh& mesh, const CappedSurface& surface, const std::vector<int>& points)
        : given(mesh), capped(surface), point_of_vertex(points) {
      vertex_at.assign(idx(*std::max_element(points.begin(), points.end())) + 1, -1);
      for (size_t v = 0; v < surface.cut.vertex.size(); ++v)
        vertex_at[idx(points[v])] = surface.cut.vertex[v];
    }
  };

  int new_point(const SurfacePoint& source, const SurfacePoint& target) {
    map_.source.push_back(source);
    map_.target.push_back(target);
    return map_.point_count() - 1;
  }

  void end_polygon(int source_face, int target_face) {
    map_.polygon_begin.push_back(static_cast<int>(map_.corner.size()));
    map_.source_face.push_back(source_face);
    map_.target_face.push_back(target_face);
  }

  static void name_vertices(const Side& side,
                            const Piece& disc,
                            const std::vector<int>& point_of_vertex,
                            const std::vector<int>& name,
                            std::vector<int>& named) {
    for (size_t w = 0; w < disc.point.size(); ++w) {
      const int q = disc.point[w];
      if (q < 0 || idx(q) >= side.vertex_at.size() || side.vertex_at[idx(q)] < 0) continue;
      named[idx(side.vertex_at[idx(q)])] = name[idx(point_of_vertex[w])];
    }
  }

  const SurfaceMap& closed_;
  std::array<Side, 2> sides_;
  SurfaceMap map_;
  std::vector<int> kept_;  ///< per point of the closed map: its number in the new one, or -1
};

}  // namespace

JoinedMap join_openings(const SurfaceMap& closed,
                        const TriangleMesh& source,
                        const CappedSurface& capped_source,
                        const TriangleMesh& target,
                        const CappedSurface& capped_target,
                        const std::vector<int>& kept) {
  const std::vector<int> partner = match_caps(closed, capped_source, capped_target);
  std::vector<Joint> joints;
  // A wide strip strains the map less; a narrow one finds room.
  for (const double width : {0.15, 0.05, 0.0}) {
    std::vector<Joint> made;
    for (Opening& opening :
         find_openings(capped_source,
                       cap_regions(closed, capped_source, capped_target, partner, kept, width))) {
      CollarPart a{source, capped_source, {}}, b{target, capped_target, {}};
      for (const int i : opening.caps) {
        a.openings.push_back(&capped_source.caps[idx(i)]);
        b.openings.push_back(&capped_target.caps[idx(partner[idx(i)])]);
      }
      if (auto collar = make_collar(closed, opening.region, a, b))
        made.push_back({std::move(opening), std::move(*collar)});
    }
    if (joints.empty() || cap_count(made) > cap_count(joints)) joints = std::move(made);
    if (cap_count(joints) == capped_source.caps.size()) break;
  }
  JoinedMap result;
  count_left(capped_source, capped_target, joints, result);
  if (result.handles[0] > 0 || result.handles[1] > 0) {
    std::erase_if(joints, [&](const Joint& j) { return is_handle(capped_source, j); });
    count_left(capped_source, capped_target, joints, result);
  }
  Assembly assembly(closed, source, capped_source, target, capped_target);
  assembly.add_rest(joints);
  for (const Joint& joint : joints) assembly.add(joint.collar);
  result.map = assembly.take();
  return result;
}

}  // namespace crosspatch
