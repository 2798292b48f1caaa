#include "param/surface_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Weight of `p` on corners outside `face`.
double weight_outside(const TriangleMesh& mesh, const SurfacePoint& p, int face) {
  double outside = 0;
  for (int k = 0; k < 3; ++k) {
    const int v = mesh.F(p.face, k);
    const auto row = mesh.F.row(face);
    if (row[0] != v && row[1] != v && row[2] != v) outside += std::abs(p.bary[k]);
  }
  return outside;
}

bool on_boundary_edge(const TriangleMesh& mesh, const SurfacePoint& p, const SurfacePoint& q) {
  std::vector<int> vertices;
  for (const SurfacePoint* point : {&p, &q})
    for (int k = 0; k < 3; ++k)
      if (point->bary[k] > 1e-9) vertices.push_back(mesh.F(point->face, k));
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (vertices.size() != 2) return false;
  const int h = find_halfedge(mesh, vertices[0], vertices[1]);
  const int g = find_halfedge(mesh, vertices[1], vertices[0]);
  return (h >= 0) != (g >= 0);
}

Status check_polygons(const SurfaceMap& map, const TriangleMesh& a, const TriangleMesh& b) {
  if (map.source.size() != map.target.size() || map.target_face.size() != map.source_face.size() ||
      map.polygon_begin.size() != map.source_face.size() + 1)
    return fail(ErrorCode::kInternal, "surface map: array sizes disagree");
  // Weight on a third corner that rounding leaves on a point of an edge.
  constexpr double kRounding = 1e-7;
  for (int p = 0; p < map.polygon_count(); ++p) {
    if (map.polygon_begin[at(p) + 1] - map.polygon_begin[at(p)] < 3)
      return fail(ErrorCode::kInternal, fmt::format("surface map: polygon {} has no area", p));
    for (int i = map.polygon_begin[at(p)]; i < map.polygon_begin[at(p) + 1]; ++i) {
      const int q = map.corner[at(i)];
      if (weight_outside(a, map.source[at(q)], map.source_face[at(p)]) > kRounding ||
          weight_outside(b, map.target[at(q)], map.target_face[at(p)]) > kRounding)
        return fail(
            ErrorCode::kInternal,
            fmt::format("surface map: point {} lies outside the faces of polygon {}", q, p));
    }
  }
  return {};
}

/// Number of edges of a map of which every side is used once in each direction, or, where `ends`
/// says so, once: it is told whether the side lies on a boundary of the source and of the target.
template <class Ends>
Result<int> check_sides(const SurfaceMap& map,
                        const TriangleMesh& source,
                        const TriangleMesh& target,
                        Ends ends) {
  if (Status s = check_polygons(map, source, target); !s) return tl::unexpected(s.error());
  std::vector<std::pair<int, int>> sides;
  sides.reserve(map.corner.size());
  for (int p = 0; p < map.polygon_count(); ++p) {
    const int begin = map.polygon_begin[at(p)], end = map.polygon_begin[at(p) + 1];
    for (int i = begin; i < end; ++i)
      sides.emplace_back(map.corner[at(i)], map.corner[at(i + 1 < end ? i + 1 : begin)]);
  }
  std::sort(sides.begin(), sides.end());
  if (std::adjacent_find(sides.begin(), sides.end()) != sides.end())
    return fail(ErrorCode::kInternal, "surface map: a side is used twice in one direction");
  int edges = 0;
  for (const auto& [i, j] : sides) {
    const bool paired = std::binary_search(sides.begin(), sides.end(), std::pair(j, i));
    edges += !paired || i < j ? 1 : 0;
    if (paired) continue;
    if (!ends(on_boundary_edge(source, map.source[at(i)], map.source[at(j)]),
              on_boundary_edge(target, map.target[at(i)], map.target[at(j)])))
      return fail(ErrorCode::kInternal, fmt::format("surface map: side ({}, {}) is loose", i, j));
  }
  return edges;
}

}  // namespace

Status validate(const SurfaceMap& map, const TriangleMesh& source, const TriangleMesh& target) {
  const auto edges = check_sides(
      map, source, target, [](bool on_source, bool on_target) { return on_source && on_target; });
  if (!edges) return tl::unexpected(edges.error());
  std::vector<bool> used(map.source.size(), false);
  for (int q : map.corner) used[at(q)] = true;
  const int points = static_cast<int>(std::count(used.begin(), used.end(), true));
  const int euler = points - *edges + map.polygon_count();
  if (euler != euler_characteristic(source) || euler != euler_characteristic(target))
    return fail(ErrorCode::kInternal,
                fmt::format("surface map: Euler characteristic {} differs from {} and {}",
                            euler,
                            euler_characteristic(source),
                            euler_characteristic(target)));
  return {};
}

Status validate_partial(const SurfaceMap& map,
                        const TriangleMesh& source,
                        const TriangleMesh& target) {
  const auto edges = check_sides(
      map, source, target, [](bool on_source, bool on_target) { return on_source || on_target; });
  if (!edges) return tl::unexpected(edges.error());
  return {};
}

SurfaceMap without_caps(const SurfaceMap& map, const FilledMesh& source, const FilledMesh& target) {
  SurfaceMap part;
  std::vector<int> kept(map.source.size(), -1);
  for (int p = 0; p < map.polygon_count(); ++p) {
    const int fa = map.source_face[at(p)], fb = map.target_face[at(p)];
    if (fa >= source.face_count || fb >= target.face_count) continue;
    for (int i = map.polygon_begin[at(p)]; i < map.polygon_begin[at(p) + 1]; ++i) {
      const size_t q = at(map.corner[at(i)]);
      if (kept[q] < 0) {
        kept[q] = part.point_count();
        part.source.push_back(in_face(source.mesh, map.source[q], fa));
        part.target.push_back(in_face(target.mesh, map.target[q], fb));
      }
      part.corner.push_back(kept[q]);
    }
    part.polygon_begin.push_back(static_cast<int>(part.corner.size()));
    part.source_face.push_back(fa);
    part.target_face.push_back(fb);
  }
  for (int v = 0; v < source.vertex_count; ++v)
    part.point_of_source_vertex.push_back(kept[at(map.point_of_source_vertex[at(v)])]);
  for (int v = 0; v < target.vertex_count; ++v)
    part.point_of_target_vertex.push_back(kept[at(map.point_of_target_vertex[at(v)])]);
  return part;
}

SurfacePoint in_face(const TriangleMesh& mesh, const SurfacePoint& p, int face) {
  if (p.face == face) return p;
  SurfacePoint q{face, Vector3d::Zero()};
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      if (mesh.F(p.face, k) == mesh.F(face, j)) q.bary[j] = p.bary[k];
  const double sum = q.bary.sum();
  if (sum > 0) q.bary /= sum;
  return q;
}

std::vector<int> faces_at(const TriangleMesh& mesh, const SurfacePoint& p) {
  std::vector<int> faces{p.face};
  for (int k = 0; k < 3; ++k) {
    if (p.bary[k] == 1) {
      for_each_outgoing(mesh, mesh.F(p.face, k), [&](int h) {
        if (face_of(h) != p.face) faces.push_back(face_of(h));
      });
      return faces;
    }
    const int h = 3 * p.face + (k + 1) % 3;  // opposite to corner k
    if (p.bary[k] == 0 && p.bary[(k + 1) % 3] != 1 && p.bary[(k + 2) % 3] != 1 &&
        mesh.twin[at(h)] >= 0)
      faces.push_back(face_of(mesh.twin[at(h)]));
  }
  return faces;
}

SurfaceMap identity_map(const TriangleMesh& mesh) {
  SurfaceMap map;
  for (int v = 0; v < mesh.vertex_count(); ++v) map.source.push_back(point_at_vertex(mesh, v));
  map.target = map.source;
  map.corner.assign(mesh.F.data(), mesh.F.data() + mesh.F.size());
  for (int f = 0; f < mesh.face_count(); ++f) map.polygon_begin.push_back(3 * (f + 1));
  map.source_face.resize(at(mesh.face_count()));
  std::iota(map.source_face.begin(), map.source_face.end(), 0);
  map.target_face = map.source_face;
  map.point_of_source_vertex.resize(at(mesh.vertex_count()));
  std::iota(map.point_of_source_vertex.begin(), map.point_of_source_vertex.end(), 0);
  map.point_of_target_vertex = map.point_of_source_vertex;
  return map;
}

SurfaceMap inverse(const SurfaceMap& map) {
  SurfaceMap r = map;
  std::swap(r.source, r.target);
  std::swap(r.source_face, r.target_face);
  std::swap(r.point_of_source_vertex, r.point_of_target_vertex);
  return r;
}

}  // namespace crosspatch
