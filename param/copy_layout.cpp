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

/// Copies the arcs and refines the target's faces that they touch.
class Copy {
 public:
  Copy(const DrawnLayout& drawn, const SurfaceMap& map, const TriangleMesh& target)
      : drawn_(drawn),
        map_(map),
        target_(target),
        source_rims_(map, map.source_face),
        target_rims_(map, map.target_face),
        vertex_(idx(map.point_count()), -1),
        touched_(idx(target.face_count()), false) {}

  Result<DrawnLayout> run();

 private:
  Status follow_arcs();
  void mark_touched();
  void number_vertices();
  void add_touched_faces();
  Status add_whole_faces();
  void add_polygon(std::vector<int> points, int face);

  const DrawnLayout& drawn_;
  const SurfaceMap& map_;
  const TriangleMesh& target_;
  FaceRims source_rims_, target_rims_;
  std::vector<int> vertex_;    ///< per overlay point: vertex of the result, or -1
  std::vector<bool> touched_;  ///< per target face: an arc runs inside
  std::vector<std::vector<int>> arc_points_;
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

void Copy::mark_touched() {
  std::map<std::pair<int, int>, int> left;  // target face left of each overlay side
  for (int p = 0; p < map_.polygon_count(); ++p) {
    const int begin = map_.polygon_begin[idx(p)], end = map_.polygon_begin[idx(p) + 1];
    for (int i = begin; i < end; ++i)
      left[{map_.corner[idx(i)], map_.corner[idx(i + 1 < end ? i + 1 : begin)]}] =
          map_.target_face[idx(p)];
  }
  for (const std::vector<int>& points : arc_points_)
    for (size_t i = 1; i < points.size(); ++i) {
      const int f = left.at({points[i - 1], points[i]}), g = left.at({points[i], points[i - 1]});
      if (f == g) touched_[idx(f)] = true;
    }
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
  for (const std::vector<int>& points : arc_points_)
    std::for_each(points.begin(), points.end(), keep);
  for (int p = 0; p < map_.polygon_count(); ++p)
    if (touched_[idx(map_.target_face[idx(p)])])
      for (int i = map_.polygon_begin[idx(p)]; i < map_.polygon_begin[idx(p) + 1]; ++i)
        keep(map_.corner[idx(i)]);
}

/// Triangulates a convex polygon as the fan whose narrowest triangle is widest.
void Copy::add_polygon(std::vector<int> points, int face) {
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

void Copy::add_touched_faces() {
  for (int p = 0; p < map_.polygon_count(); ++p)
    if (touched_[idx(map_.target_face[idx(p)])])
      add_polygon({map_.corner.begin() + map_.polygon_begin[idx(p)],
                   map_.corner.begin() + map_.polygon_begin[idx(p) + 1]},
                  map_.target_face[idx(p)]);
}

Status Copy::add_whole_faces() {
  for (int f = 0; f < target_.face_count(); ++f) {
    if (touched_[idx(f)]) continue;
    std::vector<FacePoint> boundary;
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      corners.row(k) = target_.V.row(target_.F(f, k));
      const int u = target_.F(f, k), v = target_.F(f, (k + 1) % 3);
      const std::vector<int> chain = target_rims_.chain(
          f, map_.point_of_target_vertex[idx(u)], map_.point_of_target_vertex[idx(v)]);
      if (chain.empty())
        return fail(ErrorCode::kBadInput,
                    fmt::format("layout: the map does not cover the edge ({}, {})", u, v));
      for (size_t i = 0; i + 1 < chain.size(); ++i) {
        if (vertex_[idx(chain[i])] < 0) continue;
        FacePoint point{vertex_[idx(chain[i])],
                        in_face(target_, map_.target[idx(chain[i])], f).bary};
        point.bary[(k + 2) % 3] = 0;  // on the side up to rounding: said exactly
        if (i == 0) point.bary = Vector3d::Unit(k);
        boundary.push_back(point);
      }
    }
    const FaceSubdivision cut = subdivide_face(corners, boundary, {}, std::nullopt);
    if (cut.triangles.empty())
      return fail(ErrorCode::kInternal, fmt::format("layout: face {} has no triangulation", f));
    faces_.insert(faces_.end(), cut.triangles.begin(), cut.triangles.end());
    result_.parent_face.insert(result_.parent_face.end(), cut.triangles.size(), f);
  }
  return {};
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

Result<DrawnLayout> Copy::run() {
  for (const auto* points : {&map_.point_of_source_vertex, &map_.point_of_target_vertex})
    if (std::find(points->begin(), points->end(), -1) != points->end())
      return fail(ErrorCode::kBadInput, "layout: the map leaves a vertex out");
  result_.layout = drawn_.layout;
  if (Status s = follow_arcs(); !s) return tl::unexpected(s.error());
  mark_touched();
  number_vertices();
  add_touched_faces();
  if (Status s = add_whole_faces(); !s) return tl::unexpected(s.error());
  for (const std::vector<int>& points : arc_points_) {
    std::vector<int>& path = result_.path.emplace_back();
    for (const int point : points) path.push_back(vertex_[idx(point)]);
  }
  if (Status s = finish(result_, target_, faces_); !s) return tl::unexpected(s.error());
  return std::move(result_);
}

}  // namespace

Result<DrawnLayout> copy_layout(const DrawnLayout& drawn,
                                const SurfaceMap& map,
                                const TriangleMesh& target) {
  return Copy(drawn, map, target).run();
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
