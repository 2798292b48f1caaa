#include "param/point_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "core/cut_handles.hpp"
#include "core/fill_holes.hpp"
#include "core/index.hpp"
#include "core/progressive_mesh.hpp"
#include "param/pull_back.hpp"
#include "param/sphere_clip.hpp"
#include "param/sphere_refinement.hpp"

namespace crosspatch {
namespace {

/// Great circles meet the surface most evenly when the vertices are scaled by the root of how much
/// the surface is larger there: of a scale that changes by a constant factor a length, the middle
/// of an edge then stays its middle.
void scale_rows(const TriangleMesh& mesh, MatrixX3d& X) {
  Eigen::VectorXd on_surface = Eigen::VectorXd::Zero(mesh.vertex_count()), on_sphere = on_surface;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto doubled_area = [&](const MatrixX3d& V) {
      const Vector3d a = V.row(mesh.F(f, 0)).transpose();
      return (V.row(mesh.F(f, 1)).transpose() - a)
          .cross(V.row(mesh.F(f, 2)).transpose() - a)
          .norm();
    };
    for (int k = 0; k < 3; ++k) {
      on_surface[mesh.F(f, k)] += doubled_area(mesh.V);
      on_sphere[mesh.F(f, k)] += doubled_area(X);
    }
  }
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (on_surface[v] > 0 && on_sphere[v] > 0)
      X.row(v) *= std::pow(on_surface[v] / on_sphere[v], 0.25);  // areas, hence the fourth root
}

Result<SphereSource> embed(const TriangleMesh& source) {
  const auto cut = cut_handles(source);
  if (!cut) return tl::unexpected(cut.error());
  auto filled = fill_holes(cut->mesh);
  if (!filled) return tl::unexpected(filled.error());
  SphereSource embedded{
      normalized(std::move(filled->mesh)), source.face_count(), filled->vertex_count, {}};
  const auto progressive = make_progressive_mesh(embedded.mesh);
  if (!progressive) return tl::unexpected(progressive.error());
  auto X = embed_in_sphere(embedded.mesh, *progressive);
  if (!X) return tl::unexpected(X.error());
  embedded.X = std::move(*X);
  scale_rows(embedded.mesh, embedded.X);
  return embedded;
}

/// A hash to a number in (0, 1): the same on every machine.
double scattered(std::uint64_t seed) {
  seed += 0x9e3779b97f4a7c15U;
  seed = (seed ^ seed >> 30U) * 0xbf58476d1ce4e5b9U;
  seed = (seed ^ seed >> 27U) * 0x94d049bb133111ebU;
  return (static_cast<double>((seed ^ seed >> 31U) >> 11U) + 0.5) / 9007199254740992.0;
}

class Builder {
 public:
  Builder(const SphereSource& embedded,
          const TriangleMesh& source,
          const TriangleMesh& target,
          std::vector<SurfacePoint> points)
      : embedded_(embedded), source_(source), target_(target), points_(std::move(points)) {}

  PointMap build(double stretch, double slack) {
    part_coinciding_corners();
    const int faces = target_.face_count();
    std::vector<std::vector<ClippedFace>> pieces(idx(faces));
    for (int f = 0; f < faces; ++f) pieces[idx(f)] = pieces_of(f, stretch, slack);
    drop_unlike_sides(pieces);
    for (int f = 0; f < faces; ++f) add(f, pieces[idx(f)]);
    finish_points();
    PointMapStatistics& s = result_.statistics;
    s.target_triangles = faces;
    for (const auto& p : pieces) s.unmapped_target_triangles += p.empty() ? 1 : 0;
    s.source_coverage = source_coverage();
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool has_points(int f) const {
    for (int k = 0; k < 3; ++k)
      if (!points_[idx(target_.F(f, k))].valid()) return false;
    return true;
  }

  [[nodiscard]] Vector3d place_of(int v) const { return on_sphere(embedded_, points_[idx(v)]); }

  /// Corners of triangles that go back to one line or one place are moved by a ten-millionth of a
  /// face, inside it: cuts through such triangles would have no order.
  void part_coinciding_corners() {
    constexpr double kFlat = 1e-9, kShift = 1e-7;
    std::vector<bool> moves(points_.size(), false);
    for (int f = 0; f < target_.face_count(); ++f) {
      if (!has_points(f)) continue;
      const Vector3d a = place_of(target_.F(f, 0)).normalized();
      const Vector3d u = place_of(target_.F(f, 1)).normalized() - a;
      const Vector3d v = place_of(target_.F(f, 2)).normalized() - a;
      const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
      if (u.cross(v).norm() > kFlat * longest) continue;
      for (int k = 0; k < 3; ++k) moves[idx(target_.F(f, k))] = true;
    }
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (!moves[v]) continue;
      for (int k = 0; k < 3; ++k)
        points_[v].bary[k] += kShift * scattered(3 * v + std::uint64_t(k));
      points_[v].bary /= points_[v].bary.sum();
    }
  }

  [[nodiscard]] SurfacePoint source_point(int f,
                                          const ClippedFace& polygon,
                                          const ClipCorner& c) const {
    if (c.vertex >= 0) return points_[idx(target_.F(f, c.vertex))];
    SurfacePoint p{polygon.face, Vector3d::Zero()};
    if (c.source_vertex >= 0) {
      for (int k = 0; k < 3; ++k)
        if (embedded_.mesh.F(polygon.face, k) == c.source_vertex) p.bary[k] = 1;
      return p;
    }
    // On the edge ab: y = alpha X_a + beta X_b.
    Vector3d y = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      if (c.bary[k] != 0) y += c.bary[k] * on_sphere(embedded_, corners_[idx(f)][idx(k)]);
    const Vector3d a = embedded_.X.row(c.line.a).transpose();
    const Vector3d b = embedded_.X.row(c.line.b).transpose();
    const Vector3d n = a.cross(b);
    const double alpha = std::max(0.0, y.cross(b).dot(n)), beta = std::max(0.0, a.cross(y).dot(n));
    for (int k = 0; k < 3; ++k) {
      if (embedded_.mesh.F(polygon.face, k) == c.line.a) p.bary[k] = alpha / (alpha + beta);
      if (embedded_.mesh.F(polygon.face, k) == c.line.b) p.bary[k] = beta / (alpha + beta);
    }
    // A line across a cap has one end on the source: that is where its points are taken.
    if (c.line.b >= embedded_.vertex_count && polygon.face < embedded_.face_count)
      for (int k = 0; k < 3; ++k) p.bary[k] = embedded_.mesh.F(polygon.face, k) == c.line.a ? 1 : 0;
    return p;
  }

  [[nodiscard]] Vector3d source_place(int f,
                                      const ClippedFace& polygon,
                                      const ClipCorner& c) const {
    const SurfacePoint p = source_point(f, polygon, c);
    Vector3d x = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      x += p.bary[k] * embedded_.mesh.position(embedded_.mesh.F(p.face, k));
    return x;
  }

  /// The places of a triangle's corners; those that lie on a cut through a handle are on both its
  /// banks, and are taken in a face that holds all three, or where they are nearest to each other.
  [[nodiscard]] std::array<SurfacePoint, 3> on_one_bank(int f) const {
    const auto faces = [&](int k) { return faces_at(source_, points_[idx(target_.F(f, k))]); };
    const auto in = [&](int k, int face) {
      return in_face(source_, points_[idx(target_.F(f, k))], face);
    };
    const std::vector<int> second = faces(1), third = faces(2);
    for (const int face : faces(0))
      if (std::find(second.begin(), second.end(), face) != second.end() &&
          std::find(third.begin(), third.end(), face) != third.end())
        return {in(0, face), in(1, face), in(2, face)};
    std::array<std::vector<SurfacePoint>, 3> choices;
    for (int k = 0; k < 3; ++k) {
      for (const int face : faces(k)) {
        const SurfacePoint q = in(k, face);
        const auto same = [&](const SurfacePoint& other) {
          return (on_sphere(embedded_, q) - on_sphere(embedded_, other)).isZero(1e-12);
        };
        if (std::none_of(choices[idx(k)].begin(), choices[idx(k)].end(), same))
          choices[idx(k)].push_back(q);
      }
    }
    std::array<SurfacePoint, 3> best;
    double least = std::numeric_limits<double>::infinity();
    for (const SurfacePoint& a : choices[0])
      for (const SurfacePoint& b : choices[1])
        for (const SurfacePoint& c : choices[2]) {
          const Vector3d x = on_sphere(embedded_, a).normalized();
          const Vector3d y = on_sphere(embedded_, b).normalized();
          const Vector3d z = on_sphere(embedded_, c).normalized();
          const double spread = (x - y).norm() + (y - z).norm() + (z - x).norm();
          if (spread >= least) continue;
          least = spread;
          best = {a, b, c};
        }
    return best;
  }

  /// The pieces of a target triangle; none where it has no complete way back.
  std::vector<ClippedFace> pieces_of(int f, double stretch, double slack) {
    if (!has_points(f)) return {};
    std::array<SurfacePoint, 3> points;
    std::array<int, 3> vertices;
    std::array<double, 3> bound;
    const double unit = std::sqrt(total_area_);
    constexpr double kOpposite = -0.98;  // a cosine: between opposite points there is no one way
    bool torn = false;
    for (int k = 0; k < 3; ++k) vertices[idx(k)] = target_.F(f, k);
    points = corners_[idx(f)] = on_one_bank(f);
    for (int k = 0; k < 3; ++k) {
      const int u = vertices[idx(k)], v = vertices[idx((k + 1) % 3)];
      bound[idx(k)] = stretch * (target_.position(v) - target_.position(u)).norm() / unit + slack;
      // Straight through space is shorter than any way over the surface.
      torn = torn || (embedded_position(v) - embedded_position(u)).norm() > bound[idx(k)] ||
             on_sphere(embedded_, points[idx(k)])
                     .normalized()
                     .dot(on_sphere(embedded_, points[idx((k + 1) % 3)]).normalized()) < kOpposite;
    }
    std::vector<ClippedFace> pieces;
    if (!torn) pieces = clip_to_source(embedded_, points, vertices);
    std::array<double, 3> length{0, 0, 0};
    for (const ClippedFace& piece : pieces)
      for (std::size_t i = 0; i < piece.corners.size(); ++i)
        if (const int side = piece.lines[i].side; side >= 0)
          length[idx(side)] +=
              (source_place(f, piece, piece.corners[(i + 1) % piece.corners.size()]) -
               source_place(f, piece, piece.corners[i]))
                  .norm();
    for (int k = 0; k < 3; ++k) torn = torn || length[idx(k)] > bound[idx(k)];
    if (torn) {
      ++result_.statistics.torn_target_triangles;
      return {};
    }
    return take_off_caps(pieces) ? pieces : std::vector<ClippedFace>{};
  }

  /// Great circles bulge over the outline of an open source: what lies on a cap is taken to the
  /// edge of the source before it. False where a triangle does not just reach over the outline.
  [[nodiscard]] bool take_off_caps(std::vector<ClippedFace>& pieces) const {
    constexpr double kMostBeyond = 0.5;  // ours: else most of the triangle lies over a hole
    double beyond = 0;
    for (ClippedFace& piece : pieces) {
      if (piece.face < embedded_.face_count) continue;
      beyond += area_share(piece);
      const bool has_middle =
          std::any_of(piece.corners.begin(), piece.corners.end(), [&](const ClipCorner& c) {
            return c.source_vertex >= embedded_.vertex_count;
          });
      int before = -1, sides = 0;
      for (int h = 3 * piece.face; h < 3 * piece.face + 3; ++h)
        if (const int f = face_of(embedded_.mesh.twin[idx(h)]); f < embedded_.face_count) {
          before = f;
          ++sides;
        }
      if (has_middle || sides != 1) return false;  // a hole of three edges has no inside
      piece.face = before;
    }
    return beyond <= kMostBeyond;
  }

  [[nodiscard]] Vector3d embedded_position(int v) const {
    const SurfacePoint& p = points_[idx(v)];
    return position(embedded_.mesh, p);
  }

  /// The source edges that cross each side of a triangle.
  [[nodiscard]] std::set<std::pair<int, int>> crossings(const std::vector<ClippedFace>& pieces,
                                                        int side) const {
    std::set<std::pair<int, int>> found;
    for (const ClippedFace& piece : pieces)
      for (const ClipCorner& c : piece.corners)
        if (c.side == side) found.emplace(c.line.a, c.line.b);
    return found;
  }

  /// Rounding can cut the two sides of an edge in different ways; there would be a crack.
  void drop_unlike_sides(std::vector<std::vector<ClippedFace>>& pieces) const {
    std::vector<int> drop;
    for (int h = 0; h < target_.halfedge_count(); ++h) {
      const int twin = target_.twin[idx(h)];
      if (twin < h) continue;
      const auto &here = pieces[idx(face_of(h))], &there = pieces[idx(face_of(twin))];
      if (here.empty() || there.empty() || crossings(here, h % 3) == crossings(there, twin % 3))
        continue;
      drop.push_back(face_of(h));
      drop.push_back(face_of(twin));
    }
    for (const int f : drop) pieces[idx(f)].clear();
  }

  int point_of(int f, const ClippedFace& polygon, const ClipCorner& c) {
    std::tuple<int, int, int, int> key;
    if (c.vertex >= 0) {
      key = {0, target_.F(f, c.vertex), 0, 0};
    } else if (c.source_vertex >= 0) {
      key = {1, f, c.source_vertex, 0};
    } else {
      const int h = 3 * f + c.side, twin = target_.twin[idx(h)];
      key = {2, twin < 0 ? h : std::min(h, twin), c.line.a, c.line.b};
    }
    const auto [entry, fresh] = number_.try_emplace(key, result_.map.point_count());
    if (fresh) {
      result_.map.source.push_back(source_point(f, polygon, c));
      result_.map.target.push_back(c.vertex >= 0 ? point_at_vertex(target_, target_.F(f, c.vertex))
                                                 : SurfacePoint{f, c.bary});
    }
    return entry->second;
  }

  void add(int f, const std::vector<ClippedFace>& pieces) {
    SurfaceMap& map = result_.map;
    for (const ClippedFace& piece : pieces) {
      for (const ClipCorner& c : piece.corners) map.corner.push_back(point_of(f, piece, c));
      map.polygon_begin.push_back(static_cast<int>(map.corner.size()));
      map.source_face.push_back(piece.face);
      map.target_face.push_back(f);
    }
  }

  /// Pieces that overlap count as one where they overfill a face.
  [[nodiscard]] double source_coverage() const {
    const SurfaceMap& map = result_.map;
    std::vector<double> share(idx(source_.face_count()), 0.0);
    for (int p = 0; p < map.polygon_count(); ++p) {
      const int f = map.source_face[idx(p)];
      const auto bary = [&](int i) {
        return in_face(source_, map.source[idx(map.corner[idx(i)])], f).bary;
      };
      const int begin = map.polygon_begin[idx(p)];
      double area = 0;
      for (int i = begin + 1; i + 1 < map.polygon_begin[idx(p + 1)]; ++i)
        area += signed_share(bary(begin), bary(i), bary(i + 1));
      share[idx(f)] += std::abs(area);
    }
    const Eigen::VectorXd areas = face_areas(source_);
    double covered = 0;
    for (int f = 0; f < source_.face_count(); ++f)
      covered += std::min(1.0, share[idx(f)]) * areas[f];
    return covered / areas.sum();
  }

  void finish_points() {
    SurfaceMap& map = result_.map;
    map.point_of_target_vertex.assign(idx(target_.vertex_count()), -1);
    for (int v = 0; v < target_.vertex_count(); ++v) {
      if (!points_[idx(v)].valid()) {
        ++result_.statistics.target_vertices_without;
        continue;
      }
      const auto [entry, fresh] = number_.try_emplace({0, v, 0, 0}, map.point_count());
      if (fresh) {  // none of its triangles is mapped
        map.source.push_back(points_[idx(v)]);
        map.target.push_back(point_at_vertex(target_, v));
      }
      map.point_of_target_vertex[idx(v)] = entry->second;
    }
    map.point_of_source_vertex.assign(idx(source_.vertex_count()), -1);
    for (int q = map.point_count() - 1; q >= 0; --q)
      for (int k = 0; k < 3; ++k)
        if (map.source[idx(q)].bary[k] == 1)
          map.point_of_source_vertex[idx(source_.F(map.source[idx(q)].face, k))] = q;
  }

  const SphereSource& embedded_;
  const TriangleMesh& source_;
  const TriangleMesh& target_;
  std::vector<SurfacePoint> points_;
  /// Per target face: its corners' points, on one bank of each cut.
  std::vector<std::array<SurfacePoint, 3>> corners_ =
      std::vector<std::array<SurfacePoint, 3>>(idx(target_.face_count()));
  double total_area_ = total_area(target_);
  PointMap result_;
  std::map<std::tuple<int, int, int, int>, int> number_;
};

}  // namespace

Result<PointMap> map_from_points(const TriangleMesh& source,
                                 const TriangleMesh& target,
                                 const std::vector<SurfacePoint>& images,
                                 const PointMapOptions& options) {
  auto embedded = embed(source);
  if (!embedded) return tl::unexpected(embedded.error());
  const double ratio = std::sqrt(total_area(target) / total_area(source));
  PullBack back =
      pull_back(source, target, images, options.stretch * ratio, options.slack * mean_edge(target));
  // The embedded surface has area 1.
  const double slack = options.slack * mean_edge(embedded->mesh);
  PointMap result =
      Builder(*embedded, source, target, std::move(back.points)).build(options.stretch, slack);
  PointMapStatistics& s = result.statistics;
  s.source_triangles = source.face_count();
  s.torn_source_triangles = back.torn_triangles;
  s.turned_source_triangles = back.turned_triangles;
  s.unmapped_source_vertices = static_cast<int>(std::count_if(
      images.begin(), images.end(), [](const SurfacePoint& p) { return !p.valid(); }));
  return result;
}

}  // namespace crosspatch
