#include "param/copy_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "core/index.hpp"
#include "param/face_subdivision.hpp"
#include "param/predicates.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// The polygon sides of an overlay that lie on the boundary of a mesh face: from a point on it the
/// next one, counter-clockwise.
class FaceRims {
 public:
  FaceRims(const SurfaceMap& map, const std::vector<int>& face) {
    std::map<std::pair<int, int>, int> face_left;
    const auto each_side = [&](auto visit) {
      for (int p = 0; p < map.polygon_count(); ++p) {
        const int begin = map.polygon_begin[idx(p)], end = map.polygon_begin[idx(p) + 1];
        for (int i = begin; i < end; ++i)
          visit(map.corner[idx(i)], map.corner[idx(i + 1 < end ? i + 1 : begin)], face[idx(p)]);
      }
    };
    each_side([&](int i, int j, int f) { face_left[{i, j}] = f; });
    each_side([&](int i, int j, int f) {
      const auto across = face_left.find({j, i});
      if (across == face_left.end() || across->second != f) next_[{f, i}] = j;
    });
  }

  /// Points of the overlay on the side of `face` from point p to point q, both included; empty if
  /// the overlay has no such chain.
  [[nodiscard]] std::vector<int> chain(int face, int p, int q) const {
    std::vector<int> points{p};
    while (points.back() != q) {
      const auto at = next_.find({face, points.back()});
      if (at == next_.end() || at->second == p) return {};
      points.push_back(at->second);
    }
    return points;
  }

 private:
  std::map<std::pair<int, int>, int> next_;  ///< (face, point)
};

/// A point of an arc's image that stays: on a vertex or an edge of the target, or inside a face.
struct Stop {
  enum class Kind { kVertex, kEdge, kFace };
  int point = -1;  ///< of the overlay
  Kind kind = Kind::kFace;
  int cell = -1;    ///< vertex, lower half-edge or face
  int before = -1;  ///< the target face that the arc came through, -1 along an edge
};
using Kind = Stop::Kind;

/// Copies the arcs and refines the target's faces that they touch. Inside a face an arc is drawn
/// straight from side to side; crowded faces are cut into all the polygons of the overlay instead.
class Copy {
 public:
  Copy(const DrawnLayout& drawn, const SurfaceMap& map, const TriangleMesh& target)
      : drawn_(drawn),
        map_(map),
        target_(target),
        source_rims_(map, map.source_face),
        target_rims_(map, map.target_face),
        vertex_(idx(map.point_count()), -1),
        crowded_(idx(target.face_count()), false) {}

  /// `whole`: every face that an arc runs in counts as crowded.
  Result<DrawnLayout> run(bool whole);

 private:
  Status follow_arcs();
  void place_points();
  void find_crowded(bool whole);
  void stop_on_arc(const std::vector<int>& points);
  void push_stop(std::vector<Stop>& stops, const Stop& stop) const;
  void number_vertices();
  void add_crowded_faces();
  Status add_other_faces();
  [[nodiscard]] std::vector<FacePoint> boundary_points(int face) const;
  void add_polygon(const std::vector<int>& points, int face);
  void draw_paths();
  [[nodiscard]] bool share_side(const Stop& a, const Stop& b) const;

  const DrawnLayout& drawn_;
  const SurfaceMap& map_;
  const TriangleMesh& target_;
  FaceRims source_rims_, target_rims_;
  std::map<std::pair<int, int>, int> left_;  ///< target face left of each side of the overlay
  std::vector<Stop> place_;                  ///< per overlay point
  std::vector<int> vertex_;                  ///< per overlay point: vertex of the result, or -1
  std::vector<bool> crowded_;                ///< per target face
  std::vector<std::vector<int>> arc_points_;
  std::vector<std::vector<Stop>> stops_;
  std::map<int, std::vector<std::array<int, 2>>> chords_;  ///< per face, by overlay points
  std::map<int, int> centre_;                              ///< per face: the point of a node inside
  std::vector<std::array<int, 3>> faces_;
  DrawnLayout result_;
};

Status Copy::follow_arcs() {
  for (const std::vector<int>& path : drawn_.path) {
    std::vector<int>& points = arc_points_.emplace_back();
    points.push_back(map_.point_of_source_vertex[idx(path.front())]);
    for (size_t i = 1; i < path.size(); ++i) {
      const int h = find_halfedge(drawn_.mesh, path[i - 1], path[i]);
      const std::vector<int> chain =
          source_rims_.chain(face_of(h),
                             map_.point_of_source_vertex[idx(path[i - 1])],
                             map_.point_of_source_vertex[idx(path[i])]);
      if (chain.empty())
        return fail(
            ErrorCode::kBadInput,
            fmt::format("layout: the map has no image of the edge ({}, {})", path[i - 1], path[i]));
      points.insert(points.end(), chain.begin() + 1, chain.end());
    }
  }
  return {};
}

/// Says of each overlay point which vertex, edge or face of the target it lies on.
void Copy::place_points() {
  place_.resize(idx(map_.point_count()));
  for (int p = 0; p < map_.polygon_count(); ++p) {
    const int begin = map_.polygon_begin[idx(p)], end = map_.polygon_begin[idx(p) + 1];
    for (int i = begin; i < end; ++i) {
      const int u = map_.corner[idx(i)], v = map_.corner[idx(i + 1 < end ? i + 1 : begin)];
      left_[{u, v}] = map_.target_face[idx(p)];
      Stop& at = place_[idx(u)];
      if (at.point < 0) {
        at = {u, Kind::kFace, map_.target_face[idx(p)], -1};
      } else if (at.kind == Kind::kFace && at.cell != map_.target_face[idx(p)]) {
        for (int h = 3 * at.cell; at.kind == Kind::kFace && h < 3 * at.cell + 3; ++h)
          if (const int t = target_.twin[idx(h)];
              t >= 0 && face_of(t) == map_.target_face[idx(p)]) {
            at.kind = Kind::kEdge;
            at.cell = std::min(h, t);
            break;
          }
      }
    }
  }
  for (int v = 0; v < target_.vertex_count(); ++v) {
    const int point = map_.point_of_target_vertex[idx(v)];
    place_[idx(point)] = {point, Kind::kVertex, v, -1};
  }
}

void Copy::find_crowded(bool whole) {
  std::vector<int> nodes(crowded_.size(), 0);
  for (const int v : drawn_.node_vertex) {
    const Stop& at = place_[idx(map_.point_of_source_vertex[idx(v)])];
    if (at.kind != Kind::kFace) continue;
    centre_[at.cell] = at.point;
    if (++nodes[idx(at.cell)] > 1) crowded_[idx(at.cell)] = true;
  }
  for (const std::vector<int>& points : arc_points_)
    for (size_t i = 1; whole && i < points.size(); ++i) {
      const int f = left_.at({points[i - 1], points[i]}), g = left_.at({points[i], points[i - 1]});
      if (f == g) crowded_[idx(f)] = true;
    }
}

bool Copy::share_side(const Stop& a, const Stop& b) const {
  const auto holds = [&](const Stop& edge, const Stop& vertex) {
    return edge.kind == Kind::kEdge && vertex.kind == Kind::kVertex &&
           (target_.from(edge.cell) == vertex.cell || target_.to(edge.cell) == vertex.cell);
  };
  if (a.kind == Kind::kVertex && b.kind == Kind::kVertex) return true;
  return holds(a, b) || holds(b, a) ||
         (a.kind == Kind::kEdge && b.kind == Kind::kEdge && a.cell == b.cell);
}

/// Appends a stop; a detour into a face and back over the same side is left out. The first stop is
/// a node and stays.
void Copy::push_stop(std::vector<Stop>& stops, const Stop& stop) const {
  const auto detour = [&](const Stop& a, const Stop& b) {
    return share_side(a, b) && (stop.before < 0 || !crowded_[idx(stop.before)]);
  };
  const bool last_is_edge = stops.back().kind == Kind::kEdge && stops.size() > 1;
  if (stop.kind == Kind::kEdge && detour(stops.back(), stop)) {
    if (last_is_edge) stops.pop_back();
    return;
  }
  while (stop.kind == Kind::kVertex && stops.size() > 1 && stops.back().kind == Kind::kEdge &&
         detour(stops.back(), stop))
    stops.pop_back();
  stops.push_back(stop);
}

void Copy::stop_on_arc(const std::vector<int>& points) {
  std::vector<Stop> stops{place_[idx(points.front())]};
  for (size_t i = 1; i < points.size(); ++i) {
    Stop stop = place_[idx(points[i])];
    const int f = left_.at({points[i - 1], points[i]}), g = left_.at({points[i], points[i - 1]});
    stop.before = f == g ? f : -1;
    if (i + 1 == points.size())
      stops.push_back(stop);  // a node, which stays whatever it is next to
    else if (stop.kind != Kind::kFace || crowded_[idx(stop.cell)])
      push_stop(stops, stop);
  }
  // Before the last node the same detours are possible.
  while (stops.size() > 2 && stops[stops.size() - 2].kind == Kind::kEdge &&
         share_side(stops[stops.size() - 2], stops.back()) &&
         (stops.back().before < 0 || !crowded_[idx(stops.back().before)]))
    stops.erase(stops.end() - 2);
  for (size_t i = 1; i < stops.size(); ++i) {
    const int f = stops[i].before;
    if (f < 0 || crowded_[idx(f)] || share_side(stops[i - 1], stops[i])) continue;
    chords_[f].push_back({stops[i - 1].point, stops[i].point});
  }
  stops_.push_back(std::move(stops));
}

void Copy::number_vertices() {
  for (int v = 0; v < target_.vertex_count(); ++v) {
    vertex_[idx(map_.point_of_target_vertex[idx(v)])] = v;
    result_.origin.push_back(point_at_vertex(target_, v));
  }
  const auto keep = [&](int point) {
    if (vertex_[idx(point)] >= 0) return;
    vertex_[idx(point)] = static_cast<int>(result_.origin.size());
    result_.origin.push_back(map_.target[idx(point)]);
  };
  for (const std::vector<Stop>& stops : stops_)
    for (const Stop& stop : stops) keep(stop.point);
  for (int p = 0; p < map_.polygon_count(); ++p)
    if (crowded_[idx(map_.target_face[idx(p)])])
      for (int i = map_.polygon_begin[idx(p)]; i < map_.polygon_begin[idx(p) + 1]; ++i)
        keep(map_.corner[idx(i)]);
}

/// Triangulates a convex polygon as the fan whose narrowest triangle is widest.
void Copy::add_polygon(const std::vector<int>& points, int face) {
  const size_t n = points.size();
  const auto place = [&](size_t i) { return position(target_, map_.target[idx(points[i % n])]); };
  size_t best = 0;
  double widest = -1;
  for (size_t apex = 0; apex < n && n > 3; ++apex) {
    double narrowest = HUGE_VAL;
    for (size_t i = 1; i + 1 < n; ++i) {
      const Vector3d a = place(apex), b = place(apex + i), c = place(apex + i + 1);
      const double longest =
          std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm(), 1e-300});
      narrowest = std::min(narrowest, (b - a).cross(c - a).norm() / longest);
    }
    if (narrowest > widest) {
      widest = narrowest;
      best = apex;
    }
  }
  for (size_t i = 1; i + 1 < n; ++i) {
    faces_.push_back({vertex_[idx(points[best])],
                      vertex_[idx(points[(best + i) % n])],
                      vertex_[idx(points[(best + i + 1) % n])]});
    result_.parent_face.push_back(face);
  }
}

void Copy::add_crowded_faces() {
  for (int p = 0; p < map_.polygon_count(); ++p)
    if (crowded_[idx(map_.target_face[idx(p)])])
      add_polygon({map_.corner.begin() + map_.polygon_begin[idx(p)],
                   map_.corner.begin() + map_.polygon_begin[idx(p) + 1]},
                  map_.target_face[idx(p)]);
}

/// The kept points on the sides of a face; empty if the map does not cover them.
std::vector<FacePoint> Copy::boundary_points(int face) const {
  std::vector<FacePoint> boundary;
  for (int k = 0; k < 3; ++k) {
    const int u = target_.F(face, k), v = target_.F(face, (k + 1) % 3);
    const std::vector<int> chain = target_rims_.chain(
        face, map_.point_of_target_vertex[idx(u)], map_.point_of_target_vertex[idx(v)]);
    if (chain.empty()) return {};
    for (size_t i = 0; i + 1 < chain.size(); ++i) {
      if (vertex_[idx(chain[i])] < 0) continue;
      FacePoint point{vertex_[idx(chain[i])], Vector3d::Unit(k)};
      if (i > 0) {
        point.bary = in_face(target_, map_.target[idx(chain[i])], face).bary;
        point.bary[(k + 2) % 3] = 0;  // on the side up to rounding: said exactly
      }
      boundary.push_back(point);
    }
  }
  return boundary;
}

/// True if `bary` can replace the centre of the cut: all triangles around it stay positive.
bool fits(const FaceSubdivision& cut,
          const std::vector<FacePoint>& boundary,
          int centre,
          const Vector3d& bary) {
  const auto place = [&](int vertex) -> Vector3d {
    for (const FacePoint& p : boundary)
      if (p.vertex == vertex) return p.bary;
    return bary;
  };
  return std::all_of(cut.triangles.begin(), cut.triangles.end(), [&](const auto& t) {
    return std::find(t.begin(), t.end(), centre) == t.end() ||
           orient_sphere(place(t[0]), place(t[1]), place(t[2])) > 0;
  });
}

Status Copy::add_other_faces() {
  for (int f = 0; f < target_.face_count(); ++f) {
    if (crowded_[idx(f)]) continue;
    const std::vector<FacePoint> boundary = boundary_points(f);
    if (boundary.empty())
      return fail(ErrorCode::kBadInput,
                  fmt::format("layout: the map does not cover the sides of face {}", f));
    const auto index_of = [&](int point) {
      const auto at = std::find_if(boundary.begin(), boundary.end(), [&](const FacePoint& p) {
        return p.vertex == vertex_[idx(point)];
      });
      return static_cast<int>(at - boundary.begin());
    };
    std::optional<FaceCentre> centre;
    if (const auto at = centre_.find(f); at != centre_.end())
      centre = FaceCentre{vertex_[idx(at->second)], {}, {}};
    std::vector<std::array<int, 2>> chords;
    for (const auto& [u, v] : chords_[f]) {
      const int a = index_of(u), b = index_of(v);
      if (centre && vertex_[idx(u)] == centre->vertex)
        centre->spokes.push_back(b);
      else if (centre && vertex_[idx(v)] == centre->vertex)
        centre->spokes.push_back(a);
      else
        chords.push_back({a, b});
    }
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.row(k) = target_.V.row(target_.F(f, k));
    const FaceSubdivision cut = subdivide_face(corners, boundary, chords, centre);
    if (cut.triangles.empty())
      return fail(ErrorCode::kInternal, fmt::format("layout: face {} has no triangulation", f));
    if (centre) {
      const Vector3d image = map_.target[idx(centre_.at(f))].bary;
      const bool good =
          map_.target[idx(centre_.at(f))].face == f && fits(cut, boundary, centre->vertex, image);
      result_.origin[idx(centre->vertex)] = {f, good ? image : cut.centre};
    }
    faces_.insert(faces_.end(), cut.triangles.begin(), cut.triangles.end());
    result_.parent_face.insert(result_.parent_face.end(), cut.triangles.size(), f);
  }
  return {};
}

/// Joins the stops of each arc; along a side of a face, through the other vertices kept there.
void Copy::draw_paths() {
  for (const std::vector<Stop>& stops : stops_) {
    std::vector<int>& path = result_.path.emplace_back();
    for (size_t i = 0; i < stops.size(); ++i) {
      if (i > 0 && share_side(stops[i - 1], stops[i])) {
        const Stop &a = stops[i - 1], &b = stops[i];
        const int h = a.kind == Kind::kEdge   ? a.cell
                      : b.kind == Kind::kEdge ? b.cell
                                              : find_halfedge(target_, a.cell, b.cell);
        if (h >= 0) {
          std::vector<int> side =
              target_rims_.chain(face_of(h),
                                 map_.point_of_target_vertex[idx(target_.from(h))],
                                 map_.point_of_target_vertex[idx(target_.to(h))]);
          auto from = std::find(side.begin(), side.end(), a.point);
          auto to = std::find(side.begin(), side.end(), b.point);
          if (to < from) {
            std::reverse(side.begin(), side.end());
            from = std::find(side.begin(), side.end(), a.point);
            to = std::find(side.begin(), side.end(), b.point);
          }
          for (; from < to; ++from)
            if (vertex_[idx(*from)] >= 0 && *from != a.point) path.push_back(vertex_[idx(*from)]);
        }
      }
      path.push_back(vertex_[idx(stops[i].point)]);
    }
  }
}

/// Fills mesh, node_vertex and patch of a drawing whose other parts are set.
Status finish(DrawnLayout& drawn,
              const TriangleMesh& given,
              const std::vector<std::array<int, 3>>& faces) {
  MatrixX3d V(static_cast<Eigen::Index>(drawn.origin.size()), 3);
  V.topRows(given.vertex_count()) = given.V;
  for (int v = given.vertex_count(); v < V.rows(); ++v)
    V.row(v) = position(given, drawn.origin[idx(v)]);
  MatrixX3i F(static_cast<Eigen::Index>(faces.size()), 3);
  for (size_t f = 0; f < faces.size(); ++f)
    F.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  auto mesh = make_mesh(std::move(V), std::move(F));
  if (!mesh) return tl::unexpected(mesh.error());
  drawn.mesh = std::move(*mesh);
  drawn.node_vertex.assign(drawn.layout.nodes.size(), -1);
  for (int d = 0; d < 2 * drawn.layout.arc_count(); ++d) {
    const std::vector<int>& path = drawn.path[idx(d / 2)];
    drawn.node_vertex[idx(drawn.layout.node[idx(d)])] = d % 2 == 0 ? path.front() : path.back();
  }
  auto patch = label_patches(drawn.mesh, drawn.layout, drawn.path);
  if (!patch) return tl::unexpected(patch.error());
  drawn.patch = std::move(*patch);
  return {};
}

Result<DrawnLayout> Copy::run(bool whole) {
  result_.layout = drawn_.layout;
  if (Status s = follow_arcs(); !s) return tl::unexpected(s.error());
  place_points();
  find_crowded(whole);
  for (const std::vector<int>& points : arc_points_) stop_on_arc(points);
  number_vertices();
  add_crowded_faces();
  if (Status s = add_other_faces(); !s) return tl::unexpected(s.error());
  draw_paths();
  if (Status s = finish(result_, target_, faces_); !s) return tl::unexpected(s.error());
  return std::move(result_);
}

}  // namespace

Result<DrawnLayout> copy_layout(const DrawnLayout& drawn,
                                const SurfaceMap& map,
                                const TriangleMesh& target) {
  for (const auto* points : {&map.point_of_source_vertex, &map.point_of_target_vertex})
    if (std::find(points->begin(), points->end(), -1) != points->end())
      return fail(ErrorCode::kBadInput, "layout: the map leaves a vertex out");
  // Straight pieces fail only where a node lies on an edge or a vertex beside other arcs; the
  // overlay's own polygons cannot, but they are many and thin.
  auto copy = Copy(drawn, map, target).run(false);
  if (copy && validate(*copy)) return copy;
  return Copy(drawn, map, target).run(true);
}

std::string layout_to_obj(const DrawnLayout& drawn) {
  std::string text = "# quad layout: one line element per arc\n";
  int count = 0;
  std::string lines;
  for (const std::vector<int>& path : drawn.path) {
    lines += "l";
    for (const int v : path) {
      text +=
          fmt::format("v {} {} {}\n", drawn.mesh.V(v, 0), drawn.mesh.V(v, 1), drawn.mesh.V(v, 2));
      lines += fmt::format(" {}", ++count);
    }
    lines += "\n";
  }
  constexpr std::array<const char*, 3> kKinds{"minimum", "saddle", "maximum"};
  for (size_t n = 0; n < drawn.layout.nodes.size(); ++n)
    text += fmt::format("# node {} {} {} {}\n",
                        n,
                        kKinds[static_cast<size_t>(drawn.layout.nodes[n].kind)],
                        drawn.node_vertex[n],
                        drawn.layout.nodes[n].free ? "free" : "kept");
  return text + lines;
}

}  // namespace crosspatch
