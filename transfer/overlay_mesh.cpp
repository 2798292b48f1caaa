#include "transfer/overlay_mesh.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "core/index.hpp"
#include "transfer/triangulate.hpp"

namespace crosspatch {

std::vector<bool> filled_faces(const TriangleMesh& target, const SurfaceMap& map) {
  // Accumulated rounding of an overlay's barycentric coordinates.
  constexpr double kMissing = 1e-6;
  std::vector<double> area(idx(target.face_count()), 0.0);
  for (int p = 0; p < map.polygon_count(); ++p) {
    const int f = map.target_face[idx(p)];
    const int begin = map.polygon_begin[idx(p)], end = map.polygon_begin[idx(p + 1)];
    const auto bary = [&](int i) {
      return in_face(target, map.target[idx(map.corner[idx(i)])], f).bary;
    };
    for (int i = begin + 1; i + 1 < end; ++i)
      area[idx(f)] += signed_area(bary(begin), bary(i), bary(i + 1));
  }
  std::vector<bool> filled(area.size());
  for (std::size_t f = 0; f < area.size(); ++f) filled[f] = std::abs(area[f] - 1) < kMissing;
  return filled;
}

namespace {

/// Polygons of the overlay and how their sides meet. Side c runs from corner c to the next corner
/// of its polygon; corners and sides share one numbering.
struct Sides {
  std::vector<int> polygon;    ///< per corner
  std::vector<int> following;  ///< next corner of the same polygon
  std::vector<int> opposite;   ///< side that runs the other way between the same points, or -1
  std::vector<bool> used;      ///< per polygon: its target face is filled
};

Sides make_sides(const SurfaceMap& map, const std::vector<bool>& filled) {
  Sides s;
  s.polygon.resize(map.corner.size());
  s.following.resize(map.corner.size());
  s.opposite.assign(map.corner.size(), -1);
  s.used.resize(idx(map.polygon_count()));
  std::vector<std::tuple<int, int, int>> ends;
  for (int p = 0; p < map.polygon_count(); ++p) {
    s.used[idx(p)] = filled[idx(map.target_face[idx(p)])];
    const int begin = map.polygon_begin[idx(p)], end = map.polygon_begin[idx(p + 1)];
    for (int c = begin; c < end; ++c) {
      s.polygon[idx(c)] = p;
      s.following[idx(c)] = c + 1 < end ? c + 1 : begin;
      const int i = map.corner[idx(c)], j = map.corner[idx(s.following[idx(c)])];
      if (s.used[idx(p)]) ends.emplace_back(std::min(i, j), std::max(i, j), c);
    }
  }
  std::sort(ends.begin(), ends.end());
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const auto [i, j, c] = ends[k];
    const auto [i2, j2, d] = ends[k + 1];
    if (i != i2 || j != j2 || map.corner[idx(c)] == map.corner[idx(d)]) continue;
    s.opposite[idx(c)] = d;
    s.opposite[idx(d)] = c;
  }
  return s;
}

/// The half-edge of `face`, with `other` across it (-1: boundary), that points p and q lie on best.
int edge_between(
    const TriangleMesh& mesh, int face, int other, const SurfacePoint& p, const SurfacePoint& q) {
  int best = -1;
  double best_weight = 0;
  for (int k = 0; k < 3; ++k) {
    const int h = 3 * face + k;
    const int twin = mesh.twin[idx(h)];
    if ((twin < 0 ? -1 : face_of(twin)) != other) continue;
    const int tip = (k + 2) % 3;
    const double weight =
        std::abs(in_face(mesh, p, face).bary[tip]) + std::abs(in_face(mesh, q, face).bary[tip]);
    if (best < 0 || weight < best_weight) {
      best = h;
      best_weight = weight;
    }
  }
  return best;
}

class Builder {
 public:
  Builder(const SourceAttributes& attributes,
          const TriangleMesh& source,
          const TriangleMesh& target,
          const SurfaceMap& map)
      : attributes_(attributes),
        source_(source),
        target_(target),
        map_(map),
        filled_(filled_faces(target, map)),
        sides_(make_sides(map, filled_)) {}

  OverlayMesh build() {
    mesh_.points = map_.target;
    mesh_.map_points = map_.point_count();
    mesh_.target_vertex.assign(mesh_.points.size(), false);
    point_of_vertex_ = map_.point_of_target_vertex;
    point_of_vertex_.resize(idx(target_.vertex_count()), -1);
    mark_sides();
    snap_points();
    make_wedges();
    for (int p = 0; p < map_.polygon_count(); ++p)
      if (sides_.used[idx(p)]) add_polygon(p);
    for (int f = 0; f < target_.face_count(); ++f)
      if (!filled_[idx(f)]) add_unmapped_face(f);
    return std::move(mesh_);
  }

 private:
  bool usable(int polygon) const { return attributes_.usable[idx(map_.source_face[idx(polygon)])]; }

  bool is_seam(int side, int opposite) const {
    const int p = sides_.polygon[idx(side)], q = sides_.polygon[idx(opposite)];
    if (!usable(p) || !usable(q)) return usable(p) != usable(q);
    const int f = map_.source_face[idx(p)], g = map_.source_face[idx(q)];
    if (f == g) return false;
    const int h = edge_between(source_,
                               f,
                               g,
                               map_.source[idx(map_.corner[idx(side)])],
                               map_.source[idx(map_.corner[idx(opposite)])]);
    return h < 0 || !attributes_.continuous[idx(h)];
  }

  void mark_sides() {
    marks_.assign(map_.corner.size(), kExact);
    edge_.assign(map_.corner.size(), -1);
    for (int c = 0; c < static_cast<int>(map_.corner.size()); ++c) {
      const int p = sides_.polygon[idx(c)];
      if (!sides_.used[idx(p)]) continue;
      const int d = sides_.opposite[idx(c)];
      const int f = map_.target_face[idx(p)];
      const int g = d < 0 ? -1 : map_.target_face[idx(sides_.polygon[idx(d)])];
      if (d >= 0 && is_seam(c, d)) {
        marks_[idx(c)] |= kSeam;
        if (c < d) ++mesh_.seam_sides;
      }
      if (f != g) mark_target_edge(c, f, d);
    }
  }

  void mark_target_edge(int c, int face, int opposite) {
    const SurfacePoint& p = map_.target[idx(map_.corner[idx(c)])];
    const SurfacePoint& q = map_.target[idx(map_.corner[idx(sides_.following[idx(c)])])];
    int h = -1;
    if (opposite >= 0) {
      h = edge_between(target_, face, map_.target_face[idx(sides_.polygon[idx(opposite)])], p, q);
    } else {
      // Nothing across: the target's boundary, or a face that is not filled.
      double best = 0;
      for (int k = 0; k < 3; ++k) {
        const int twin = target_.twin[idx(3 * face + k)];
        if (twin >= 0 && filled_[idx(face_of(twin))]) continue;
        const int e = edge_between(target_, face, twin < 0 ? -1 : face_of(twin), p, q);
        const int tip = (e % 3 + 2) % 3;
        const double weight = std::abs(in_face(target_, p, face).bary[tip]) +
                              std::abs(in_face(target_, q, face).bary[tip]);
        if (h < 0 || weight < best) {
          h = e;
          best = weight;
        }
      }
      if (h >= 0 && target_.twin[idx(h)] >= 0) marks_[idx(c)] |= kSeam;
    }
    if (h < 0) return;
    marks_[idx(c)] |= kTargetEdge;
    edge_[idx(c)] = h;
  }

  /// Gives points on edges and vertices of the target exact zeros.
  void snap_points() {
    for (int c = 0; c < static_cast<int>(map_.corner.size()); ++c) {
      const int h = edge_[idx(c)];
      if (h < 0) continue;
      for (const int q : {map_.corner[idx(c)], map_.corner[idx(sides_.following[idx(c)])]}) {
        SurfacePoint p = in_face(target_, mesh_.points[idx(q)], face_of(h));
        p.bary[(h % 3 + 2) % 3] = 0;
        p.bary = p.bary.cwiseMax(0.0);
        p.bary /= p.bary.sum();
        mesh_.points[idx(q)] = p;
        const int twin = target_.twin[idx(h)];
        edge_points_[twin < 0 ? h : std::min(h, twin)].push_back(q);
      }
    }
    for (int v = 0; v < target_.vertex_count(); ++v) {
      const int q = point_of_vertex_[idx(v)];
      if (q < 0) continue;
      mesh_.points[idx(q)] = point_at_vertex(target_, v);
      mesh_.target_vertex[idx(q)] = true;
    }
  }

  int new_wedge(int point) {
    mesh_.wedge_point.push_back(point);
    mesh_.attributes.resize(mesh_.attributes.size() + idx(attributes_.width), 0.0);
    return static_cast<int>(mesh_.wedge_point.size()) - 1;
  }

  /// Corners of polygons on one side of all seams at a point become one wedge.
  void make_wedges() {
    std::vector<int> root(map_.corner.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int c) {
      while (root[idx(c)] != c) c = root[idx(c)] = root[idx(root[idx(c)])];
      return c;
    };
    const auto join = [&](int c, int d) {
      const int a = find(c), b = find(d);
      root[idx(std::max(a, b))] = std::min(a, b);
    };
    for (int c = 0; c < static_cast<int>(root.size()); ++c) {
      const int d = sides_.opposite[idx(c)];
      if (d < 0 || (marks_[idx(c)] & kSeam) != 0) continue;
      join(c, sides_.following[idx(d)]);
      join(sides_.following[idx(c)], d);
    }
    wedge_of_corner_.assign(root.size(), -1);
    for (int c = 0; c < static_cast<int>(root.size()); ++c) {
      const int p = sides_.polygon[idx(c)];
      if (!sides_.used[idx(p)]) continue;
      const int r = find(c);
      if (wedge_of_corner_[idx(r)] < 0) {
        const int point = map_.corner[idx(c)];
        const int w = wedge_of_corner_[idx(r)] = new_wedge(point);
        if (usable(p) && attributes_.width > 0)
          evaluate(attributes_,
                   in_face(source_, map_.source[idx(point)], map_.source_face[idx(p)]),
                   &mesh_.attributes[idx(w * attributes_.width)]);
      }
      wedge_of_corner_[idx(c)] = wedge_of_corner_[idx(r)];
    }
  }

  std::array<Vector2d, 3> frame(int f) const {
    return lay_flat(target_.position(target_.F(f, 0)),
                    target_.position(target_.F(f, 1)),
                    target_.position(target_.F(f, 2)));
  }

  /// Cuts a polygon of `face` into triangles; side i runs from wedges[i] to the next.
  void cut(const std::vector<int>& wedges,
           const std::vector<std::uint8_t>& side_marks,
           OverlayMesh::Triangle pattern) {
    const int n = static_cast<int>(wedges.size());
    std::vector<Vector3d> bary;
    bary.reserve(wedges.size());
    for (const int w : wedges)
      bary.push_back(
          in_face(target_, mesh_.points[idx(mesh_.wedge_point[idx(w)])], pattern.target_face).bary);
    auto triangles = triangulate(bary, frame(pattern.target_face));
    if (triangles.empty()) {
      ++mesh_.degenerate_polygons;
      for (int i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
    }
    for (const auto& t : triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int i = t[k], j = t[(k + 1) % 3];
        pattern.wedge[k] = wedges[idx(i)];
        pattern.side[k] = j == (i + 1) % n ? side_marks[idx(i)] : std::uint8_t{kExact};
      }
      mesh_.triangles.push_back(pattern);
    }
  }

  void add_polygon(int p) {
    const int begin = map_.polygon_begin[idx(p)], end = map_.polygon_begin[idx(p + 1)];
    OverlayMesh::Triangle pattern;
    pattern.target_face = map_.target_face[idx(p)];
    pattern.mapped = usable(p);
    pattern.material = pattern.mapped ? attributes_.material[idx(map_.source_face[idx(p)])] : -1;
    cut({wedge_of_corner_.begin() + begin, wedge_of_corner_.begin() + end},
        {marks_.begin() + begin, marks_.begin() + end},
        pattern);
  }

  int point_at(int v) {
    int& q = point_of_vertex_[idx(v)];
    if (q < 0) {
      q = static_cast<int>(mesh_.points.size());
      mesh_.points.push_back(point_at_vertex(target_, v));
      mesh_.target_vertex.push_back(true);
    }
    return q;
  }

  void add_unmapped_face(int f) {
    ++mesh_.unmapped_faces;
    std::vector<int> loop;
    std::vector<std::uint8_t> side_marks;
    for (int k = 0; k < 3; ++k) {
      const int h = 3 * f + k, twin = target_.twin[idx(h)];
      loop.push_back(point_at(target_.F(f, k)));
      const auto found = edge_points_.find(twin < 0 ? h : std::min(h, twin));
      if (found != edge_points_.end()) {
        std::vector<std::pair<double, int>> along;
        for (const int q : found->second)
          if (!mesh_.target_vertex[idx(q)])
            along.emplace_back(in_face(target_, mesh_.points[idx(q)], f).bary[(k + 1) % 3], q);
        std::sort(along.begin(), along.end());
        along.erase(std::unique(along.begin(), along.end()), along.end());
        for (const auto& entry : along) loop.push_back(entry.second);
      }
      const std::uint8_t mark =
          twin >= 0 && filled_[idx(face_of(twin))] ? kTargetEdge | kSeam : kTargetEdge;
      side_marks.resize(loop.size(), static_cast<std::uint8_t>(mark | kExact));
    }
    std::vector<int> wedges;
    wedges.reserve(loop.size());
    for (const int q : loop) {
      // Wedges of unmapped faces carry zeros, so that one a point is enough.
      const auto [entry, fresh] = plain_wedge_.try_emplace(q, -1);
      if (fresh) entry->second = new_wedge(q);
      wedges.push_back(entry->second);
    }
    OverlayMesh::Triangle pattern;
    pattern.target_face = f;
    pattern.mapped = false;
    cut(wedges, side_marks, pattern);
  }

  const SourceAttributes& attributes_;
  const TriangleMesh& source_;
  const TriangleMesh& target_;
  const SurfaceMap& map_;
  std::vector<bool> filled_;
  Sides sides_;
  OverlayMesh mesh_;
  std::vector<int> point_of_vertex_;
  std::vector<std::uint8_t> marks_;              ///< per side
  std::vector<int> edge_;                        ///< per side: half-edge of the target, or -1
  std::map<int, std::vector<int>> edge_points_;  ///< overlay points by half-edge of the target
  std::vector<int> wedge_of_corner_;
  std::map<int, int> plain_wedge_;
};

}  // namespace

OverlayMesh make_overlay_mesh(const SourceAttributes& attributes,
                              const TriangleMesh& source,
                              const TriangleMesh& target,
                              const SurfaceMap& map) {
  return Builder(attributes, source, target, map).build();
}

}  // namespace crosspatch
