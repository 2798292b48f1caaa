#include "param/drawn_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/index.hpp"
#include "param/arc_strands.hpp"
#include "param/face_subdivision.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Kind = StrandStop::Kind;

/// Places a vertex at every stop and notes the chords from stop to stop in each face.
class Drawing {
 public:
  Drawing(const QuadLayout& layout, const DiscreteGradient& gradient)
      : layout_(layout), mesh_(gradient.surface), strands_(arc_strands(layout, gradient)) {}

  Result<DrawnLayout> run();

 private:
  using EdgeKey = std::tuple<int, int, int>;  ///< lower half-edge, zone, rank

  void number_vertices();
  void place_on_edges();
  Status add_chords(int arc);
  Status cut_faces();
  [[nodiscard]] int vertex_of(const StrandStop& stop) const;
  [[nodiscard]] int common_face(const StrandStop& a, const StrandStop& b) const;
  [[nodiscard]] std::vector<FacePoint> boundary_points(int face) const;

  const QuadLayout& layout_;
  const TriangleMesh& mesh_;
  std::vector<std::vector<StrandStop>> strands_;
  std::map<EdgeKey, int> edge_vertex_;       ///< in the order along each edge
  std::map<int, std::vector<int>> on_edge_;  ///< per lower half-edge, from its start
  std::map<int, int> face_vertex_;
  std::map<int, std::vector<std::array<int, 2>>> chords_;  ///< per face, by vertices
  std::map<int, std::vector<int>> spokes_;                 ///< per face with a centre
  /// Per face: chords (u, v) that part the corner w, and what is on its side, from the centre.
  std::map<int, std::vector<std::array<int, 3>>> outside_;
  std::vector<std::array<int, 3>> faces_;
  DrawnLayout result_;
};

void Drawing::number_vertices() {
  result_.origin.reserve(idx(mesh_.vertex_count()));
  for (int v = 0; v < mesh_.vertex_count(); ++v)
    result_.origin.push_back(point_at_vertex(mesh_, v));
  for (const auto& stops : strands_)
    for (const StrandStop& stop : stops) {
      if (stop.kind == Kind::kEdge) edge_vertex_[{stop.cell, stop.zone, stop.rank}] = -1;
      if (stop.kind == Kind::kFace) face_vertex_[stop.cell] = -1;
    }
  int n = mesh_.vertex_count();
  for (auto& [key, vertex] : edge_vertex_) {
    vertex = n++;
    on_edge_[std::get<0>(key)].push_back(vertex);
  }
  for (auto& [face, vertex] : face_vertex_) vertex = n++;
  result_.origin.resize(idx(n));
}

void Drawing::place_on_edges() {
  for (const auto& [h, vertices] : on_edge_)
    for (size_t i = 0; i < vertices.size(); ++i) {
      SurfacePoint p{face_of(h), Vector3d::Zero()};
      const double t = static_cast<double>(i + 1) / static_cast<double>(vertices.size() + 1);
      p.bary[h % 3] = 1 - t;
      p.bary[(h + 1) % 3] = t;
      result_.origin[idx(vertices[i])] = p;
    }
}

int Drawing::vertex_of(const StrandStop& stop) const {
  if (stop.kind == Kind::kVertex) return stop.cell;
  if (stop.kind == Kind::kFace) return face_vertex_.at(stop.cell);
  return edge_vertex_.at({stop.cell, stop.zone, stop.rank});
}

/// The face that holds both stops, -1 if there is none.
int Drawing::common_face(const StrandStop& a, const StrandStop& b) const {
  const StrandStop& edge = a.kind == Kind::kEdge ? a : b;
  const StrandStop& other = a.kind == Kind::kEdge ? b : a;
  if (edge.kind != Kind::kEdge) return -1;
  for (const int h : {edge.cell, mesh_.twin[idx(edge.cell)]}) {
    const int f = face_of(h);
    for (int g = 3 * f; g < 3 * f + 3; ++g)
      if ((other.kind == Kind::kFace && other.cell == f) ||
          (other.kind == Kind::kVertex && mesh_.from(g) == other.cell) ||
          (other.kind == Kind::kEdge && (g == other.cell || mesh_.twin[idx(g)] == other.cell)))
        return f;
  }
  return -1;
}

Status Drawing::add_chords(int arc) {
  const std::vector<StrandStop>& stops = strands_[idx(arc)];
  for (size_t i = 0; i < stops.size(); ++i) {
    result_.path[idx(arc)].push_back(vertex_of(stops[i]));
    if (i == 0) continue;
    const StrandStop &a = stops[i - 1], &b = stops[i];
    const int u = vertex_of(a), v = vertex_of(b);
    if (a.kind == Kind::kVertex && b.kind == Kind::kVertex) continue;  // along an edge
    const auto along = [&](const StrandStop& edge, const StrandStop& end) {
      return edge.kind == Kind::kEdge && end.kind == Kind::kVertex &&
             (mesh_.from(edge.cell) == end.cell || mesh_.to(edge.cell) == end.cell);
    };
    if (along(a, b) || along(b, a)) continue;
    const int f = common_face(a, b);
    if (f < 0)
      return fail(ErrorCode::kInternal,
                  fmt::format("layout: stops {} and {} of arc {} share no face", i - 1, i, arc));
    if (b.kind == Kind::kFace)
      spokes_[f].push_back(u);
    else
      chords_[f].push_back({u, v});
    // A descending arc that leaves a saddle beside an end of its edge has that end on one side and
    // the ascending arcs on the other.
    if (i == 1 && b.kind != Kind::kFace && arc % 2 == 0)
      outside_[f].push_back({u, v, arc % 4 == 2 ? mesh_.from(a.cell) : mesh_.to(a.cell)});
  }
  return {};
}

std::vector<FacePoint> Drawing::boundary_points(int face) const {
  std::vector<FacePoint> points;
  for (int h = 3 * face; h < 3 * face + 3; ++h) {
    points.push_back({mesh_.from(h), Vector3d::Unit(h % 3)});
    const int twin = mesh_.twin[idx(h)];
    const auto at = on_edge_.find(std::min(h, twin));
    if (at == on_edge_.end()) continue;
    std::vector<int> along = at->second;
    if (twin < h) std::reverse(along.begin(), along.end());
    for (const int v : along)
      points.push_back({v, in_face(mesh_, result_.origin[idx(v)], face).bary});
  }
  return points;
}

/// The points strictly between a and b, in a cycle of `count`, on the side of c.
std::vector<int> beside_chord(int count, int a, int b, int c) {
  const auto between = [&](int from, int to) {
    std::vector<int> points;
    for (int i = (from + 1) % count; i != to; i = (i + 1) % count) points.push_back(i);
    return points;
  };
  const std::vector<int> points = between(a, b);
  return std::find(points.begin(), points.end(), c) != points.end() ? points : between(b, a);
}

Status Drawing::cut_faces() {
  for (int f = 0; f < mesh_.face_count(); ++f) {
    const std::vector<FacePoint> boundary = boundary_points(f);
    const auto index_of = [&](int vertex) {
      const auto at = std::find_if(
          boundary.begin(), boundary.end(), [&](const FacePoint& p) { return p.vertex == vertex; });
      return static_cast<int>(at - boundary.begin());
    };
    std::vector<std::array<int, 2>> chords;
    if (const auto at = chords_.find(f); at != chords_.end())
      for (const auto& [u, v] : at->second) chords.push_back({index_of(u), index_of(v)});
    std::optional<FaceCentre> centre;
    if (const auto at = face_vertex_.find(f); at != face_vertex_.end()) {
      centre = FaceCentre{at->second, {}, {}};
      for (const auto& [u, v, w] : outside_[f])
        for (const int i :
             beside_chord(static_cast<int>(boundary.size()), index_of(u), index_of(v), index_of(w)))
          centre->outside.push_back(i);
      for (const int u : spokes_[f]) centre->spokes.push_back(index_of(u));
    }
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.row(k) = mesh_.V.row(mesh_.F(f, k));
    const FaceSubdivision cut = subdivide_face(corners, boundary, chords, centre);
    if (cut.triangles.empty())
      return fail(ErrorCode::kInternal, fmt::format("layout: arcs cross in face {}", f));
    if (centre) result_.origin[idx(centre->vertex)] = {f, cut.centre};
    faces_.insert(faces_.end(), cut.triangles.begin(), cut.triangles.end());
    result_.parent_face.insert(result_.parent_face.end(), cut.triangles.size(), f);
  }
  return {};
}

Result<DrawnLayout> Drawing::run() {
  result_.layout = layout_;
  result_.path.resize(idx(layout_.arc_count()));
  number_vertices();
  place_on_edges();
  for (int arc = 0; arc < layout_.arc_count(); ++arc)
    if (Status s = add_chords(arc); !s) return tl::unexpected(s.error());
  if (Status s = cut_faces(); !s) return tl::unexpected(s.error());
  MatrixX3d V(static_cast<Eigen::Index>(result_.origin.size()), 3);
  V.topRows(mesh_.vertex_count()) = mesh_.V;
  for (int v = mesh_.vertex_count(); v < V.rows(); ++v)
    V.row(v) = position(mesh_, result_.origin[idx(v)]);
  MatrixX3i F(static_cast<Eigen::Index>(faces_.size()), 3);
  for (size_t f = 0; f < faces_.size(); ++f)
    F.row(static_cast<Eigen::Index>(f)) << faces_[f][0], faces_[f][1], faces_[f][2];
  auto mesh = make_mesh(std::move(V), std::move(F));
  if (!mesh) return tl::unexpected(mesh.error());
  result_.mesh = std::move(*mesh);
  result_.node_vertex.assign(layout_.nodes.size(), -1);
  for (int d = 0; d < 2 * layout_.arc_count(); ++d) {
    const std::vector<int>& path = result_.path[idx(d / 2)];
    result_.node_vertex[idx(layout_.node[idx(d)])] = d % 2 == 0 ? path.front() : path.back();
  }
  auto patch = label_patches(result_.mesh, layout_, result_.path);
  if (!patch) return tl::unexpected(patch.error());
  result_.patch = std::move(*patch);
  return std::move(result_);
}

Status check_paths(const DrawnLayout& drawn) {
  std::vector<int> uses(idx(drawn.mesh.vertex_count()), 0);
  for (const int v : drawn.node_vertex) uses[idx(v)] = 1;
  for (int a = 0; a < drawn.layout.arc_count(); ++a) {
    const std::vector<int>& path = drawn.path[idx(a)];
    if (path.size() < 2 || path.front() != drawn.node_vertex[idx(drawn.layout.node[idx(2 * a)])] ||
        path.back() != drawn.node_vertex[idx(drawn.layout.node[idx(2 * a + 1)])])
      return fail(ErrorCode::kInternal, fmt::format("layout: arc {} misses its nodes", a));
    for (size_t i = 1; i + 1 < path.size(); ++i)
      if (uses[idx(path[i])]++ > 0)
        return fail(ErrorCode::kInternal,
                    fmt::format("layout: arc {} meets another at vertex {}", a, path[i]));
  }
  return {};
}

}  // namespace

Result<std::vector<int>> darts_on_halfedges(const TriangleMesh& mesh,
                                            const std::vector<std::vector<int>>& path) {
  std::vector<int> dart(idx(mesh.halfedge_count()), -1);
  for (size_t a = 0; a < path.size(); ++a)
    for (size_t i = 1; i < path[a].size(); ++i) {
      const int h = find_halfedge(mesh, path[a][i - 1], path[a][i]);
      const int t = find_halfedge(mesh, path[a][i], path[a][i - 1]);
      if (h < 0 || t < 0 || dart[idx(h)] >= 0)
        return fail(
            ErrorCode::kInternal,
            fmt::format(
                "layout: arc {} leaves the edges or meets another at vertex {}", a, path[a][i]));
      dart[idx(h)] = 2 * static_cast<int>(a);
      dart[idx(t)] = 2 * static_cast<int>(a) + 1;
    }
  return dart;
}

Result<std::vector<int>> label_patches(const TriangleMesh& mesh,
                                       const QuadLayout& layout,
                                       const std::vector<std::vector<int>>& path) {
  const auto dart = darts_on_halfedges(mesh, path);
  if (!dart) return tl::unexpected(dart.error());
  std::vector<int> label(idx(mesh.face_count()), -1), stack;
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    if ((*dart)[idx(h)] >= 0 && label[idx(face_of(h))] < 0) {
      label[idx(face_of(h))] = layout.face[idx((*dart)[idx(h)])];
      stack.push_back(face_of(h));
    }
  while (!stack.empty()) {
    const int f = stack.back();
    stack.pop_back();
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      const int t = mesh.twin[idx(h)];
      if ((*dart)[idx(h)] >= 0 || t < 0 || label[idx(face_of(t))] >= 0) continue;
      label[idx(face_of(t))] = label[idx(f)];
      stack.push_back(face_of(t));
    }
  }
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const int own = label[idx(face_of(h))], t = mesh.twin[idx(h)], d = (*dart)[idx(h)];
    const int expected = d >= 0 ? layout.face[idx(d)] : t >= 0 ? label[idx(face_of(t))] : own;
    if (own < 0 || own != expected)
      return fail(ErrorCode::kInternal,
                  fmt::format("layout: face {} is in patch {}, not {}", face_of(h), own, expected));
  }
  return label;
}

Result<DrawnLayout> draw_layout(const QuadLayout& layout, const DiscreteGradient& gradient) {
  if (gradient.mesh_vertex_count != gradient.surface.vertex_count())
    return fail(ErrorCode::kBadInput, "layout: arcs are drawn on surfaces without boundary only");
  return Drawing(layout, gradient).run();
}

Status validate(const DrawnLayout& drawn) {
  if (Status s = validate(drawn.layout, euler_characteristic(drawn.mesh)); !s) return s;
  if (Status s = validate(drawn.mesh); !s) return s;
  if (Status s = check_paths(drawn); !s) return s;
  const auto label = label_patches(drawn.mesh, drawn.layout, drawn.path);
  if (!label) return tl::unexpected(label.error());
  if (*label != drawn.patch) return fail(ErrorCode::kInternal, "layout: patches are mislabelled");
  // A patch cut open is connected and a disc iff its faces - inner edges + inner vertices are 1.
  std::vector<int> euler(idx(drawn.layout.face_count), 0);
  std::vector<bool> on_arc(idx(drawn.mesh.vertex_count()), false);
  for (const auto& path : drawn.path)
    for (const int v : path) on_arc[idx(v)] = true;
  const auto dart = darts_on_halfedges(drawn.mesh, drawn.path);
  for (int f = 0; f < drawn.mesh.face_count(); ++f) ++euler[idx(drawn.patch[idx(f)])];
  for (int h = 0; h < drawn.mesh.halfedge_count(); ++h)
    if ((*dart)[idx(h)] < 0 && h < drawn.mesh.twin[idx(h)])
      --euler[idx(drawn.patch[idx(face_of(h))])];
  for (int v = 0; v < drawn.mesh.vertex_count(); ++v)
    if (!on_arc[idx(v)]) ++euler[idx(drawn.patch[idx(face_of(drawn.mesh.out[idx(v)]))])];
  for (int f = 0; f < drawn.layout.face_count; ++f)
    if (euler[idx(f)] != 1)
      return fail(ErrorCode::kInternal,
                  fmt::format("layout: patch {} has inner Euler sum {}", f, euler[idx(f)]));
  return {};
}

}  // namespace crosspatch
