// Overlay of two triangulations of the sphere.
//
// Each edge of one mesh is walked through the faces of the other; the sequence of crossed edges is
// exact. A crossing is known by its pair of edges. The walks in both directions give the order of
// crossings along the edges of both meshes, so nothing is ever sorted by inexact parameters.
// Segments between consecutive nodes become pairs of darts; rotations at the nodes are known, and
// the polygons are the orbits of "arrive, turn to the next dart clockwise".
#include "param/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <unordered_map>

#include "param/lift.hpp"
#include "param/predicates.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Raised where a vertex lies on an edge of the other mesh.
struct Special {
  int vertex;  ///< of the mesh that is being walked
};

struct Embedded {
  const TriangleMesh& mesh;
  const MatrixX3d& X;

  [[nodiscard]] Vector3d x(int v) const { return X.row(v).transpose(); }
  [[nodiscard]] int edge(int h) const { return std::min(h, mesh.twin[at(h)]); }
};

/// Where the edges of one mesh run in the other.
struct Walks {
  std::vector<int> same;  ///< per vertex: the coinciding vertex of the other mesh, or -1
  std::vector<int>
      face;  ///< per vertex: the face of the other mesh that holds it (-1 if it coincides)
  std::vector<std::vector<int>>
      crossed;  ///< per half-edge h < twin: the other mesh's half-edges it leaves faces through
  std::vector<std::vector<int>>
      through;  ///< per half-edge h < twin: the faces it runs in, one more than crossed
  std::vector<int> coincident;  ///< per half-edge: the other mesh's half-edge it lies on, or -1
  std::vector<int> sector;  ///< per half-edge from a coinciding vertex: the other mesh's half-edge
                            ///< clockwise of it
};

struct RowHash {
  size_t operator()(const std::array<double, 3>& r) const {
    size_t h = 1469598103934665603ULL;
    for (double d : r) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &d, sizeof d);
      h = (h ^ bits) * 1099511628211ULL;
    }
    return h;
  }
};

std::vector<int> coinciding(const Embedded& a, const Embedded& b) {
  const auto key = [](const Embedded& m, int v) {
    return std::array{m.X(v, 0), m.X(v, 1), m.X(v, 2)};
  };
  std::unordered_map<std::array<double, 3>, int, RowHash> vertex;
  for (int v = 0; v < b.mesh.vertex_count(); ++v) vertex.emplace(key(b, v), v);
  std::vector<int> same(at(a.mesh.vertex_count()), -1);
  for (int v = 0; v < a.mesh.vertex_count(); ++v)
    if (const auto it = vertex.find(key(a, v)); it != vertex.end()) same[at(v)] = it->second;
  return same;
}

class Walker {
 public:
  Walker(const Embedded& a, const Embedded& b) : a_(a), b_(b) {}

  /// Throws Special.
  Walks run() {
    walks_.same = coinciding(a_, b_);
    locate_vertices();
    const size_t n = at(a_.mesh.halfedge_count());
    walks_.crossed.resize(n);
    walks_.through.resize(n);
    walks_.coincident.assign(n, -1);
    walks_.sector.assign(n, -1);
    for (int h = 0; h < a_.mesh.halfedge_count(); ++h) {
      if (walks_.same[at(a_.mesh.from(h))] >= 0) find_sector(h);
      if (h < a_.mesh.twin[at(h)]) walk(h);
    }
    return std::move(walks_);
  }

 private:
  void locate_vertices() {
    const MeshLift lift(b_.mesh, b_.X);
    walks_.face.assign(at(a_.mesh.vertex_count()), -1);
    int guess = 0;
    for (int v = 0; v < a_.mesh.vertex_count(); ++v) {
      if (walks_.same[at(v)] >= 0) continue;
      guess = exact_face(v, lift.locate(a_.x(v), guess));
      walks_.face[at(v)] = guess;
    }
  }

  /// The face of b that holds a's vertex v beyond doubt, looked for around `guess` and then
  /// everywhere.
  int exact_face(int v, int guess) const {
    if (holds(guess, v)) return guess;
    for (int k = 0; k < 3; ++k)
      if (const int near = b_.mesh.twin[at(3 * guess + k)] / 3; holds(near, v)) return near;
    for (int face = 0; face < b_.mesh.face_count(); ++face)
      if (holds(face, v)) return face;
    throw Special{v};
  }

  bool holds(int face, int v) const {
    const Vector3d x = a_.x(v), c[3] = {b_.x(b_.mesh.F(face, 0)),
                                        b_.x(b_.mesh.F(face, 1)),
                                        b_.x(b_.mesh.F(face, 2))};
    return orient_sphere(c[0], c[1], x) > 0 && orient_sphere(c[1], c[2], x) > 0 &&
           orient_sphere(c[2], c[0], x) > 0;
  }

  /// Side of b's vertex seen along a's directed edge u -> v.
  [[nodiscard]] int side(int u, int v, int b_vertex) const {
    return orient_sphere(a_.x(u), a_.x(v), b_.x(b_vertex));
  }

  /// Half-edge h leaves a vertex that coincides with b's vertex p: the sector of p it runs into.
  void find_sector(int h) {
    const int u = a_.mesh.from(h), v = a_.mesh.to(h), p = walks_.same[at(u)];
    for_each_outgoing(b_.mesh, p, [&](int g) {
      if (walks_.sector[at(h)] >= 0 || walks_.coincident[at(h)] >= 0) return;
      const int right = side(u, v, b_.mesh.to(g)), left = side(u, v, b_.mesh.tip(g));
      const bool ahead =
          b_.x(b_.mesh.to(g)).dot(a_.x(v) - a_.x(u)) > b_.x(p).dot(a_.x(v) - a_.x(u));
      if (right == 0 && ahead) {
        if (walks_.same[at(v)] != b_.mesh.to(g)) throw Special{walks_.same[at(v)] >= 0 ? u : v};
        walks_.coincident[at(h)] = g;
      } else if (right < 0 && left > 0) {
        walks_.sector[at(h)] = g;
      }
    });
    if (walks_.sector[at(h)] < 0 && walks_.coincident[at(h)] < 0) throw Special{u};
  }

  void walk(int h) {
    const int u = a_.mesh.from(h), v = a_.mesh.to(h), end = walks_.same[at(v)];
    if (walks_.coincident[at(h)] >= 0) return;
    auto &crossed = walks_.crossed[at(h)], &through = walks_.through[at(h)];
    const auto ends_in = [&](int face) {
      const auto row = b_.mesh.F.row(face);
      return end < 0 ? face == walks_.face[at(v)] : row[0] == end || row[1] == end || row[2] == end;
    };
    int face = 0, leave = -1;
    if (walks_.same[at(u)] >= 0) {
      face = walks_.sector[at(h)] / 3;
      leave = next(walks_.sector[at(h)]);
    } else {
      face = walks_.face[at(u)];
      for (int k = 0; k < 3 && !ends_in(face); ++k) {
        const int g = 3 * face + k, right = side(u, v, b_.mesh.from(g)),
                  left = side(u, v, b_.mesh.to(g));
        if (right == 0 || left == 0) throw Special{u};
        if (right < 0 && left > 0) leave = g;
      }
    }
    through.push_back(face);
    while (!ends_in(face)) {
      if (leave < 0 || through.size() > at(b_.mesh.face_count())) throw Special{u};
      crossed.push_back(leave);
      const int enter = b_.mesh.twin[at(leave)];
      face = enter / 3;
      through.push_back(face);
      if (ends_in(face)) break;
      const int apex = side(u, v, b_.mesh.tip(enter));
      if (apex == 0) throw Special{u};
      // enter = (q, p) with p on the right: an apex on the left is left behind through (p, apex),
      // else through (apex, q).
      leave = apex > 0 ? next(enter) : prev(enter);
    }
  }

  const Embedded& a_;
  const Embedded& b_;
  Walks walks_;
};

/// A point of an edge or a corner of a mesh.
SurfacePoint on_edge(int h, double weight_from, double weight_to) {
  SurfacePoint p{h / 3, Vector3d::Zero()};
  const double sum = weight_from + weight_to;
  p.bary[h % 3] = sum > 0 ? weight_from / sum : 0.5;
  p.bary[(h + 1) % 3] = 1 - p.bary[h % 3];
  return p;
}

class Builder {
 public:
  Builder(const Embedded& a, const Embedded& b, const Walks& wa, const Walks& wb)
      : a_(a), b_(b), wa_(wa), wb_(wb) {}

  Result<SurfaceMap> run() {
    add_vertex_nodes();
    add_crossings();
    if (!consistent_)
      return fail(ErrorCode::kInternal, "overlay: the walks through the two meshes disagree");
    add_segments();
    if (!consistent_)
      return fail(ErrorCode::kInternal, "overlay: the walks through the two meshes disagree");
    make_rotations();
    collect_polygons();
    return std::move(map_);
  }

 private:
  struct Dart {
    int to;
    int left_a, left_b;  ///< faces on the left of the dart
  };

  void add_vertex_nodes() {
    const MeshLift in_a(a_.mesh, a_.X), in_b(b_.mesh, b_.X);
    for (int v = 0; v < a_.mesh.vertex_count(); ++v) {
      int face = wa_.face[at(v)];
      map_.point_of_source_vertex.push_back(map_.point_count());
      map_.source.push_back(point_at_vertex(a_.mesh, v));
      map_.target.push_back(wa_.same[at(v)] >= 0 ? point_at_vertex(b_.mesh, wa_.same[at(v)])
                                                 : in_b.surface_point(a_.x(v), face));
    }
    for (int v = 0; v < b_.mesh.vertex_count(); ++v) {
      if (wb_.same[at(v)] >= 0) {
        map_.point_of_target_vertex.push_back(wb_.same[at(v)]);
        continue;
      }
      int face = wb_.face[at(v)];
      map_.point_of_target_vertex.push_back(map_.point_count());
      map_.source.push_back(in_a.surface_point(b_.x(v), face));
      map_.target.push_back(point_at_vertex(b_.mesh, v));
    }
  }

  static std::uint64_t key(int edge_a, int edge_b) {
    return (static_cast<std::uint64_t>(edge_a) << 32) | static_cast<std::uint32_t>(edge_b);
  }

  /// det [p q x] by differences: a small determinant keeps its digits.
  static double orientation(const Vector3d& p, const Vector3d& q, const Vector3d& x) {
    return p.dot((q - p).cross(x - p));
  }

  void add_crossings() {
    for (int h = 0; h < a_.mesh.halfedge_count(); ++h)
      for (int g : wa_.crossed[at(h)]) {
        crossing_.emplace(key(h, b_.edge(g)), map_.point_count());
        const Vector3d u = a_.x(a_.mesh.from(h)), v = a_.x(a_.mesh.to(h));
        const Vector3d p = b_.x(b_.mesh.from(g)), q = b_.x(b_.mesh.to(g));
        map_.source.push_back(
            on_edge(h, std::abs(orientation(p, q, v)), std::abs(orientation(p, q, u))));
        map_.target.push_back(
            on_edge(g, std::abs(orientation(u, v, q)), std::abs(orientation(u, v, p))));
      }
    size_t crossings = 0;
    for (const auto& crossed : wb_.crossed) crossings += crossed.size();
    consistent_ = crossings == crossing_.size();
  }

  int add_pair(int from, int to, int left_a, int left_b, int right_a, int right_b) {
    const int d = static_cast<int>(darts_.size());
    darts_.push_back({to, left_a, left_b});
    darts_.push_back({from, right_a, right_b});
    return d;
  }

  /// Darts along every edge; `first` and `last` are where the edge leaves its two ends.
  void add_segments() {
    first_a_.assign(at(a_.mesh.halfedge_count()), -1);
    first_b_.assign(at(b_.mesh.halfedge_count()), -1);
    crossing_darts_.resize(at(map_.point_count()));
    for (int h = 0; h < a_.mesh.halfedge_count(); ++h) {
      const int t = a_.mesh.twin[at(h)];
      if (h > t) continue;
      const int g = wa_.coincident[at(h)];
      const int from = map_.point_of_source_vertex[at(a_.mesh.from(h))],
                to = map_.point_of_source_vertex[at(a_.mesh.to(h))];
      if (g >= 0) {
        const int d = add_pair(from, to, h / 3, g / 3, t / 3, b_.mesh.twin[at(g)] / 3);
        first_a_[at(h)] = first_b_[at(g)] = d;
        first_a_[at(t)] = first_b_[at(b_.mesh.twin[at(g)])] = d + 1;
        continue;
      }
      std::vector<int> nodes{from};
      for (int c : wa_.crossed[at(h)]) nodes.push_back(crossing_.at(key(h, b_.edge(c))));
      nodes.push_back(to);
      for (size_t i = 0; i + 1 < nodes.size(); ++i) {
        const int f = wa_.through[at(h)][i];
        const int d = add_pair(nodes[i], nodes[i + 1], h / 3, f, t / 3, f);
        if (i == 0) first_a_[at(h)] = d;
        if (i + 2 == nodes.size()) first_a_[at(t)] = d + 1;
        if (i > 0) crossing_darts_[at(nodes[i])][0] = d;
        if (i + 2 < nodes.size()) crossing_darts_[at(nodes[i + 1])][2] = d + 1;
      }
    }
    for (int g = 0; g < b_.mesh.halfedge_count(); ++g)
      if (g < b_.mesh.twin[at(g)] && first_b_[at(g)] < 0) add_b_edge(g);
  }

  void add_b_edge(int g) {
    const int t = b_.mesh.twin[at(g)];
    std::vector<int> nodes{map_.point_of_target_vertex[at(b_.mesh.from(g))]};
    std::vector<int> crossed_from{-1};
    for (int c : wb_.crossed[at(g)]) {
      const auto it = crossing_.find(key(a_.edge(c), g));
      if (it == crossing_.end()) {
        consistent_ = false;
        return;
      }
      nodes.push_back(it->second);
      crossed_from.push_back(c);
    }
    nodes.push_back(map_.point_of_target_vertex[at(b_.mesh.to(g))]);
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
      const int f = wb_.through[at(g)][i];
      const int d = add_pair(nodes[i], nodes[i + 1], f, g / 3, f, t / 3);
      if (i == 0) first_b_[at(g)] = d;
      if (i + 2 == nodes.size()) first_b_[at(t)] = d + 1;
      // g leaves a's face through half-edge c, that is to the right of c: to the left of c's twin.
      if (i > 0) crossing_darts_[at(nodes[i])][forward_slot(crossed_from[i])] = d;
      if (i + 2 < nodes.size())
        crossing_darts_[at(nodes[i + 1])][4 - forward_slot(crossed_from[i + 1])] = d + 1;
    }
  }

  /// Rotation slots at a crossing are: 0 along a's edge (lower half-edge), 1 to its left, 2 back, 3
  /// to its right. The slot of b's edge going on after it left a's face through half-edge c.
  [[nodiscard]] size_t forward_slot(int c) const { return c < a_.mesh.twin[at(c)] ? 3 : 1; }

  void make_rotations() {
    rotation_.resize(at(map_.point_count()));
    for (int v = 0; v < a_.mesh.vertex_count(); ++v) {
      auto& darts = rotation_[at(map_.point_of_source_vertex[at(v)])];
      if (wa_.same[at(v)] >= 0)
        merge_rotation(v, darts);
      else
        for_each_outgoing(a_.mesh, v, [&](int h) { darts.push_back(first_a_[at(h)]); });
    }
    for (int v = 0; v < b_.mesh.vertex_count(); ++v)
      if (wb_.same[at(v)] < 0)
        for_each_outgoing(b_.mesh, v, [&](int g) {
          rotation_[at(map_.point_of_target_vertex[at(v)])].push_back(first_b_[at(g)]);
        });
    for (const auto& [k, node] : crossing_) {
      const auto& slots = crossing_darts_[at(node)];
      rotation_[at(node)].assign(slots.begin(), slots.end());
    }
  }

  /// Half-edges of both meshes around a common vertex, counter-clockwise.
  void merge_rotation(int v, std::vector<int>& darts) {
    std::vector<int> around;
    for_each_outgoing(a_.mesh, v, [&](int h) { around.push_back(h); });
    const auto sector = [&](size_t i) {
      const int h = around[i % around.size()];
      return wa_.coincident[at(h)] >= 0 ? -1 : wa_.sector[at(h)];
    };
    // Start where a sector begins, so that the run of each sector is in one piece.
    size_t start = 0;
    while (start < around.size() && sector(start) >= 0 &&
           sector(start) == sector(start + around.size() - 1))
      ++start;
    for_each_outgoing(b_.mesh, wa_.same[at(v)], [&](int g) {
      darts.push_back(first_b_[at(g)]);
      for (size_t i = start; i < start + around.size(); ++i)
        if (sector(i) == g) darts.push_back(first_a_[at(around[i % around.size()])]);
    });
  }

  void collect_polygons() {
    std::vector<int> next_dart(darts_.size(), -1);
    for (const auto& darts : rotation_)
      for (size_t i = 0; i < darts.size(); ++i) {
        // Arriving against darts[i], the face on the left goes on with the dart clockwise of it.
        const int arrive = darts[i] ^ 1;
        next_dart[at(arrive)] = darts[(i + darts.size() - 1) % darts.size()];
      }
    std::vector<bool> seen(darts_.size(), false);
    for (int start = 0; start < static_cast<int>(darts_.size()); ++start) {
      if (seen[at(start)]) continue;
      for (int d = start; !seen[at(d)]; d = next_dart[at(d)]) {
        seen[at(d)] = true;
        map_.corner.push_back(darts_[at(d)].to);
      }
      map_.polygon_begin.push_back(static_cast<int>(map_.corner.size()));
      map_.source_face.push_back(darts_[at(start)].left_a);
      map_.target_face.push_back(darts_[at(start)].left_b);
    }
  }

  const Embedded& a_;
  const Embedded& b_;
  const Walks& wa_;
  const Walks& wb_;
  SurfaceMap map_;
  bool consistent_ = true;
  std::unordered_map<std::uint64_t, int> crossing_;
  std::vector<Dart> darts_;
  std::vector<int> first_a_, first_b_;  ///< per half-edge: the dart by which it leaves its start
  std::vector<std::array<int, 4>> crossing_darts_;
  std::vector<std::vector<int>> rotation_;  ///< per node: outgoing darts, counter-clockwise
};

}  // namespace

Result<SurfaceMap> overlay_on_sphere(const TriangleMesh& source,
                                     const MatrixX3d& X,
                                     const TriangleMesh& target,
                                     const MatrixX3d& Y,
                                     SpecialPosition* special) {
  const Embedded a{source, X}, b{target, Y};
  bool on_source = true;
  try {
    const Walks wa = Walker(a, b).run();
    on_source = false;
    const Walks wb = Walker(b, a).run();
    return Builder(a, b, wa, wb).run();
  } catch (const Special& s) {
    if (special != nullptr) *special = {on_source, s.vertex};
    return fail(ErrorCode::kNumerical,
                fmt::format("overlay: {} vertex {} lies on an edge of the other mesh",
                            on_source ? "source" : "target",
                            s.vertex));
  }
}

}  // namespace crosspatch
