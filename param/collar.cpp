#include "param/collar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <unordered_map>

#include "core/index.hpp"
#include "core/open_along.hpp"
#include "param/disc_overlay.hpp"
#include "param/tutte.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Side = std::pair<int, int>;  ///< of a polygon, from corner to corner

/// One surface's half of a map.
struct HalfMap {
  const std::vector<SurfacePoint>& points;
  const std::vector<int>& face;             ///< per polygon
  const std::vector<int>& point_of_vertex;  ///< of the filled mesh
};

struct Annulus {
  Piece piece;
  std::vector<int> rim_points;  ///< the overlay's points on the rim of a hole
};

/// Makes an annulus of the region's polygons outside the caps.
class AnnulusMaker {
 public:
  AnnulusMaker(const SurfaceMap& closed,
               const HalfMap& half,
               const std::vector<int>& region,
               const CollarPart& part)
      : closed_(closed), half_(half), region_(region), part_(part) {
    for (size_t v = 0; v < half.point_of_vertex.size(); ++v)
      vertex_at_.emplace(half.point_of_vertex[v], static_cast<int>(v));
  }

  Result<Annulus> run() {
    std::vector<std::vector<int>> rims;
    for (const Cap* cap : part_.openings) {
      rims.push_back(rim_of(*cap));
      if (rims.back().empty())
        return fail(ErrorCode::kInternal, "collar: the image of a cap is no disc");
    }
    collect_polygons();
    Annulus annulus;
    if (rims.size() == 2)
      join_banks(rims[0], rims[1]);
    else
      annulus.rim_points = rims[0];
    auto piece =
        compact().and_then([&](const Piece& raw) { return without_chords(part_.surface, raw); });
    if (!piece) return tl::unexpected(piece.error());
    annulus.piece = std::move(*piece);
    if (euler_characteristic(annulus.piece.mesh) != 0 ||
        boundary_loops(annulus.piece.mesh).size() != 2)
      return fail(ErrorCode::kInternal, "collar: a part is no annulus");
    return annulus;
  }

 private:
  std::vector<int> corners(int p) const {
    return {closed_.corner.begin() + closed_.polygon_begin[idx(p)],
            closed_.corner.begin() + closed_.polygon_begin[idx(p) + 1]};
  }

  /// Points around the polygons of a cap, cap on the left, from a mesh vertex on; empty where they
  /// do not make one loop.
  std::vector<int> rim_of(const Cap& cap) const {
    std::set<Side> sides;
    for (const int p : region_) {
      if (!std::binary_search(cap.faces.begin(), cap.faces.end(), half_.face[idx(p)])) continue;
      const std::vector<int> c = corners(p);
      for (size_t i = 0; i < c.size(); ++i) sides.emplace(c[i], c[(i + 1) % c.size()]);
    }
    std::map<int, int> next_point;
    for (const auto& [u, v] : sides)
      if (sides.count({v, u}) == 0 && !next_point.emplace(u, v).second) return {};
    std::vector<int> loop;
    for (const auto& [u, v] : next_point)
      if (loop.empty() && vertex_at_.count(u) > 0) loop.push_back(u);
    if (loop.empty()) return {};
    while (loop.size() <= next_point.size()) {
      const auto after = next_point.find(loop.back());
      if (after == next_point.end()) return {};
      if (after->second == loop.front()) break;
      loop.push_back(after->second);
    }
    if (loop.size() != next_point.size()) return {};
    return loop;
  }

  void collect_polygons() {
    for (const int p : region_) {
      const int face = half_.face[idx(p)];
      if (face >= part_.capped.filled.face_count) continue;
      polygons_.push_back({corners(p), face});
      for (const int q : polygons_.back().corners)
        origin_.emplace(q, in_face(part_.capped.filled.mesh, half_.points[idx(q)], face));
    }
  }

  /// The given surface's vertex at a point, or -1.
  int original_at(int point) const {
    const auto at = vertex_at_.find(point);
    return at == vertex_at_.end() ? -1 : part_.capped.cut.vertex[idx(at->second)];
  }

  /// How far along the edge that ends in vertex `end` a point lies.
  double share(int point, int end) const {
    const SurfacePoint& p = origin_.at(point);
    double weight = 0;
    for (int k = 0; k < 3; ++k)
      if (part_.surface.F(p.face, k) == end) weight += p.bary[k];
    return weight;
  }

  /// Points inside the edges of a rim, by edge with the lower vertex first.
  std::map<Side, std::vector<int>> by_edge(const std::vector<int>& rim) const {
    std::map<Side, std::vector<int>> edges;
    for (size_t i = 0; i < rim.size();) {
      std::vector<int> inside;
      size_t j = i + 1;
      while (j < rim.size() && original_at(rim[j]) < 0) inside.push_back(rim[j++]);
      const int u = original_at(rim[i]), v = original_at(rim[j % rim.size()]);
      if (u > v) std::reverse(inside.begin(), inside.end());
      edges[std::minmax(u, v)] = inside;
      i = j;
    }
    return edges;
  }

  /// Both banks of a cut become one: points of either are put on the other too.
  void join_banks(const std::vector<int>& rim, const std::vector<int>& other) {
    std::array<std::map<int, int>, 2> point_at;  // by vertex of the given surface
    for (const int q : rim)
      if (const int v = original_at(q); v >= 0) point_at[0][v] = q;
    for (const int q : other)
      if (const int v = original_at(q); v >= 0) point_at[1][v] = q;
    const std::array edges{by_edge(rim), by_edge(other)};
    SidePoints between;
    for (const auto& [edge, first] : edges[0]) {
      const auto second = edges[1].find(edge);
      if (second == edges[1].end()) continue;
      const std::array<const std::vector<int>*, 2> lists{&first, &second->second};
      std::array<size_t, 2> at{0, 0};
      std::array<int, 2> last{point_at[0][edge.first], point_at[1][edge.first]};
      while (at[0] < first.size() || at[1] < second->second.size()) {
        const auto along = [&](size_t s) {
          return at[s] < lists[s]->size() ? share((*lists[s])[at[s]], edge.second) : 2.0;
        };
        const size_t s = along(0) <= along(1) ? 0 : 1;
        const int q = (*lists[s])[at[s]++];
        pending(between, last[1 - s], lists[1 - s], at[1 - s], point_at[1 - s][edge.second])
            .push_back(q);
        last[s] = q;
      }
    }
    for (PiecePolygon& p : polygons_) {
      p.corners = with_points(p.corners, between);
      for (int& q : p.corners)
        if (const int v = vertex_at_.count(q) > 0 ? original_at(q) : -1; v >= 0)
          if (const auto same = point_at[0].find(v); same != point_at[0].end()) q = same->second;
    }
  }

  /// The list of what is put between a point of a bank and the next one of the same bank.
  static std::vector<int>& pending(
      SidePoints& between, int last, const std::vector<int>* list, size_t at, int end) {
    return between[{last, at < list->size() ? (*list)[at] : end}];
  }

  Result<Piece> compact() {
    std::map<int, int> number;
    std::vector<SurfacePoint> origin;
    std::vector<int> point;
    for (PiecePolygon& p : polygons_)
      for (int& q : p.corners) {
        const auto [at, fresh] = number.emplace(q, static_cast<int>(point.size()));
        if (fresh) {
          point.push_back(q);
          origin.push_back(origin_.at(q));
        }
        q = at->second;
      }
    return triangulate(part_.surface, polygons_, std::move(origin), std::move(point));
  }

  const SurfaceMap& closed_;
  const HalfMap half_;
  const std::vector<int>& region_;
  const CollarPart& part_;
  std::unordered_map<int, int> vertex_at_;
  std::vector<PiecePolygon> polygons_;
  std::map<int, SurfacePoint> origin_;
};

/// The shortest path along inner edges from one of `begin` to one of `end`, all boundary vertices.
std::vector<int> shortest_path(const TriangleMesh& mesh,
                               const std::vector<int>& begin,
                               const std::vector<int>& end) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<double> distance(idx(mesh.vertex_count()), kFar);
  std::vector<int> before(idx(mesh.vertex_count()), -1);
  std::vector<bool> rim(idx(mesh.vertex_count()), false), goal(rim);
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin[idx(h)] < 0) rim[idx(mesh.from(h))] = true;
  for (const int v : end) goal[idx(v)] = true;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const int v : begin) {
    distance[idx(v)] = 0;
    queue.emplace(0, v);
  }
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[idx(v)]) continue;
    if (goal[idx(v)]) {
      std::vector<int> path{v};
      while (before[idx(path.back())] >= 0) path.push_back(before[idx(path.back())]);
      std::reverse(path.begin(), path.end());
      return path;
    }
    const auto step = [&](int w) {
      if (rim[idx(w)] && !goal[idx(w)]) return;
      const double there = d + (mesh.position(v) - mesh.position(w)).norm();
      if (there >= distance[idx(w)]) return;
      distance[idx(w)] = there;
      before[idx(w)] = v;
      queue.emplace(there, w);
    };
    for_each_outgoing(mesh, v, [&](int h) { step(mesh.to(h)); });
  }
  return {};
}

/// Shares of the length of a chain of vertices at which they lie, from 0 to 1; a closed chain
/// returns to its first vertex at 1.
std::vector<double> shares(const TriangleMesh& mesh, const std::vector<int>& chain, bool closed) {
  std::vector<double> at{0};
  for (size_t i = 1; i < chain.size() + (closed ? 1 : 0); ++i)
    at.push_back(at.back() +
                 (mesh.position(chain[i % chain.size()]) - mesh.position(chain[i - 1])).norm());
  for (double& s : at) s /= at.back();
  return at;
}

/// A chain of vertices that is to be refined with vertices at more shares of its length.
struct Refining {
  SidePoints between;
  std::vector<SurfacePoint> added;
  int count = 0;  ///< of the vertices there are

  /// The chain with vertices at the shares of `other` too.
  std::vector<int> refine(const TriangleMesh& parent,
                          const Piece& piece,
                          const std::vector<int>& chain,
                          const std::vector<double>& own,
                          const std::vector<double>& other) {
    constexpr double kSame = 1e-9;
    std::vector<int> all;
    size_t next_other = 0;
    for (size_t i = 0; i + 1 < own.size(); ++i) {
      const int u = chain[i], v = chain[(i + 1) % chain.size()];
      all.push_back(u);
      for (; next_other < other.size() && other[next_other] < own[i + 1] - kSame; ++next_other) {
        if (other[next_other] <= own[i] + kSame) continue;
        const double share = (other[next_other] - own[i]) / (own[i + 1] - own[i]);
        const int h = find_halfedge(piece.mesh, u, v);
        added.push_back(h >= 0
                            ? on_edge(parent, piece, h, share)
                            : on_edge(parent, piece, find_halfedge(piece.mesh, v, u), 1 - share));
        all.push_back(count);
        between[{u, v}].push_back(count++);
      }
    }
    if (own.size() == chain.size()) all.push_back(chain.back());
    return all;
  }
};

/// A boundary loop from vertex `first` on.
std::vector<int> loop_from(const TriangleMesh& mesh, int first) {
  std::vector<int> loop{first};
  for (int v = mesh.to(mesh.out[idx(first)]); v != first; v = mesh.to(mesh.out[idx(v)]))
    loop.push_back(v);
  return loop;
}

struct Scissors {
  std::vector<int> path;  ///< where the annulus is cut open
  std::vector<int> rim;   ///< of a hole, from the end of the path on; empty for handles
};

/// Where both annuli are cut, with as many vertices along paths and rims of holes on both sides.
Status choose_cuts(const std::array<const TriangleMesh*, 2>& surfaces,
                   std::array<Annulus, 2>& annuli,
                   std::array<Scissors, 2>& cuts) {
  const bool hole = !annuli[0].rim_points.empty();
  for (size_t s = 0; s < 2; ++s) {
    const Piece& piece = annuli[s].piece;
    std::vector<std::vector<int>> loops = boundary_loops(piece.mesh);
    const auto at = [&](int point) {
      return static_cast<int>(std::find(piece.point.begin(), piece.point.end(), point) -
                              piece.point.begin());
    };
    if (hole) {
      const int rim = at(annuli[s].rim_points.front());
      if (std::find(loops[0].begin(), loops[0].end(), rim) != loops[0].end())
        std::swap(loops[0], loops[1]);
    }
    if (s == 1) {
      const auto point_of = [&](int v) { return annuli[0].piece.point[idx(v)]; };
      loops[0] = {at(point_of(cuts[0].path.front()))};
      if (!hole) loops[1] = {at(point_of(cuts[0].path.back()))};
      if (loops[0][0] >= piece.mesh.vertex_count() || loops[1][0] >= piece.mesh.vertex_count())
        return fail(ErrorCode::kInternal, "collar: the parts have different rims");
    }
    cuts[s].path = shortest_path(piece.mesh, loops[0], loops[1]);
    if (cuts[s].path.size() < 3)
      return fail(ErrorCode::kInternal, "collar: no path leads from rim to rim");
    if (hole) cuts[s].rim = loop_from(piece.mesh, cuts[s].path.back());
  }
  std::array<std::vector<double>, 2> along, around;
  for (size_t s = 0; s < 2; ++s) {
    along[s] = shares(annuli[s].piece.mesh, cuts[s].path, false);
    if (hole) around[s] = shares(annuli[s].piece.mesh, cuts[s].rim, true);
  }
  for (size_t s = 0; s < 2; ++s) {
    Piece& piece = annuli[s].piece;
    Refining refining{{}, {}, piece.mesh.vertex_count()};
    cuts[s].path = refining.refine(*surfaces[s], piece, cuts[s].path, along[s], along[1 - s]);
    if (hole)
      cuts[s].rim = refining.refine(*surfaces[s], piece, cuts[s].rim, around[s], around[1 - s]);
    auto refined = with_points(*surfaces[s], piece, refining.between, refining.added);
    if (!refined) return tl::unexpected(refined.error());
    piece = std::move(*refined);
  }
  if (cuts[0].path.size() != cuts[1].path.size() || cuts[0].rim.size() != cuts[1].rim.size())
    return fail(ErrorCode::kNumerical, "collar: vertices of cuts lie too close to each other");
  return {};
}

/// Cuts the annulus open. Keys: the overlay's points on outer rims; below zero, first along the
/// path, then along the rim of a hole.
Result<CollarSide> cut_open(const Annulus& annulus, const Scissors& cut) {
  const Piece& piece = annulus.piece;
  std::vector<int> key = piece.point;
  for (size_t i = 0; i < cut.rim.size(); ++i)
    key[idx(cut.rim[i])] = -1 - static_cast<int>(cut.path.size() + i);
  for (size_t i = 1; i + 1 < cut.path.size(); ++i) key[idx(cut.path[i])] = -1 - static_cast<int>(i);
  std::vector<bool> marked(idx(piece.mesh.halfedge_count()), false);
  for (size_t i = 0; i + 1 < cut.path.size(); ++i)
    for (const int h : {find_halfedge(piece.mesh, cut.path[i], cut.path[i + 1]),
                        find_halfedge(piece.mesh, cut.path[i + 1], cut.path[i])})
      if (h >= 0) marked[idx(h)] = true;
  auto opened = open_along(piece.mesh, marked);
  if (!opened) return tl::unexpected(opened.error());
  CollarSide side;
  side.disc.mesh = std::move(opened->mesh);
  side.disc.parent_face = piece.parent_face;
  for (const int v : opened->vertex) {
    side.disc.origin.push_back(piece.origin[idx(v)]);
    side.disc.point.push_back(piece.point[idx(v)]);
  }
  const auto loops = boundary_loops(side.disc.mesh);
  if (loops.size() != 1 || euler_characteristic(side.disc.mesh) != 1)
    return fail(ErrorCode::kInternal, "collar: cut open, it is no disc");
  side.loop = loops[0];
  for (const int v : side.loop) side.loop_key.push_back(key[idx(opened->vertex[idx(v)])]);
  return side;
}

/// Turns the loop of `side` so that its keys are those of `like`.
Status align(const CollarSide& like, CollarSide& side) {
  const size_t n = side.loop.size();
  if (like.loop.size() == n)
    for (size_t turn = 0; turn < n; ++turn) {
      if (side.loop_key[turn] != like.loop_key[0]) continue;
      std::vector<int> keys = side.loop_key;
      std::rotate(keys.begin(), keys.begin() + static_cast<long>(turn), keys.end());
      if (keys != like.loop_key) continue;
      std::rotate(side.loop.begin(), side.loop.begin() + static_cast<long>(turn), side.loop.end());
      side.loop_key = std::move(keys);
      return {};
    }
  return fail(ErrorCode::kInternal, "collar: the loops of the two sides differ");
}

/// Places of the loops on a circle: turned by the mean of the lengths of both sides, but never so
/// little that rounding could make the polygon concave.
MatrixX2d on_circle(const CollarSide& a, const CollarSide& b) {
  const size_t n = a.loop.size();
  std::vector<double> length(n, 0);
  for (const CollarSide* side : {&a, &b}) {
    std::vector<int> chain = side->loop;
    const std::vector<double> at = shares(side->disc.mesh, chain, true);
    for (size_t i = 0; i < n; ++i) length[i] += at[i + 1] - at[i];
  }
  double sum = 0;
  for (double& l : length) sum += l = std::max(l, 0.1 / static_cast<double>(n));
  MatrixX2d places(static_cast<Eigen::Index>(n), 2);
  double angle = 0;
  for (size_t i = 0; i < n; ++i) {
    places.row(static_cast<Eigen::Index>(i)) << std::cos(angle), std::sin(angle);
    angle += 2 * static_cast<double>(EIGEN_PI) * length[i] / sum;
  }
  return places;
}

}  // namespace

Result<Collar> make_collar(const SurfaceMap& closed,
                           const std::vector<int>& region,
                           const CollarPart& source,
                           const CollarPart& target) {
  const std::array<const CollarPart*, 2> parts{&source, &target};
  const std::array halves{
      HalfMap{closed.source, closed.source_face, closed.point_of_source_vertex},
      HalfMap{closed.target, closed.target_face, closed.point_of_target_vertex}};
  std::array<Annulus, 2> annuli;
  for (size_t s = 0; s < 2; ++s) {
    auto made = AnnulusMaker(closed, halves[s], region, *parts[s]).run();
    if (!made) return tl::unexpected(made.error());
    annuli[s] = std::move(*made);
  }
  std::array<Scissors, 2> cuts;
  if (Status s = choose_cuts({&source.surface, &target.surface}, annuli, cuts); !s)
    return tl::unexpected(s.error());
  Collar collar;
  for (size_t s = 0; s < 2; ++s) {
    auto side = cut_open(annuli[s], cuts[s]);
    if (!side) return tl::unexpected(side.error());
    (s == 0 ? collar.source : collar.target) = std::move(*side);
  }
  if (Status s = align(collar.source, collar.target); !s) return tl::unexpected(s.error());
  const MatrixX2d places = on_circle(collar.source, collar.target);
  const auto layout = [&](const CollarSide& side) {
    TutteOptions options;
    options.weights = TutteWeights::kMeanValue;
    return tutte_embedding(side.disc.mesh, side.loop, places, options);
  };
  const auto a = layout(collar.source), b = layout(collar.target);
  if (!a) return tl::unexpected(a.error());
  if (!b) return tl::unexpected(b.error());
  auto map = overlay_discs({collar.source.disc.mesh, *a, collar.source.loop},
                           {collar.target.disc.mesh, *b, collar.target.loop});
  if (!map) return tl::unexpected(map.error());
  collar.map = std::move(*map);
  return collar;
}

}  // namespace crosspatch
