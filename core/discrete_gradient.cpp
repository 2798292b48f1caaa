#include "core/discrete_gradient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Fills `gradient` with the mesh and a cone over each boundary loop. An apex sorts right below the
/// loop's lowest vertex, so that it adds a minimum of no persistence.
Status close_surface(const TriangleMesh& mesh,
                     const Eigen::VectorXd& values,
                     DiscreteGradient& gradient) {
  const auto loops = boundary_loops(mesh);
  const int n = mesh.vertex_count(), apexes = static_cast<int>(loops.size());
  gradient.mesh_vertex_count = n;
  gradient.representative.resize(idx(n));
  std::iota(gradient.representative.begin(), gradient.representative.end(), 0);
  gradient.values = values;
  if (apexes == 0) {
    gradient.surface = mesh;
    return {};
  }
  gradient.values.conservativeResize(n + apexes);
  MatrixX3d V(n + apexes, 3);
  V.topRows(n) = mesh.V;
  std::vector<std::array<int, 3>> cones;
  for (int a = 0; a < apexes; ++a) {
    const auto& loop = loops[idx(a)];
    const int lowest = *std::min_element(loop.begin(), loop.end(), [&](int u, int v) {
      return std::pair(values[u], u) < std::pair(values[v], v);
    });
    V.row(n + a) = mesh.V.row(lowest);
    gradient.values[n + a] = values[lowest];
    gradient.representative.push_back(lowest);
    for (size_t i = 0; i < loop.size(); ++i)
      cones.push_back({loop[(i + 1) % loop.size()], loop[i], n + a});
  }
  MatrixX3i F(mesh.face_count() + static_cast<int>(cones.size()), 3);
  F.topRows(mesh.face_count()) = mesh.F;
  for (int i = 0; i < static_cast<int>(cones.size()); ++i)
    F.row(mesh.face_count() + i) << cones[idx(i)][0], cones[idx(i)][1], cones[idx(i)][2];
  auto closed = make_mesh(std::move(V), std::move(F));
  if (!closed) return tl::unexpected(closed.error());
  gradient.surface = std::move(*closed);
  return {};
}

void rank_vertices(DiscreteGradient& gradient) {
  std::vector<int> order(idx(gradient.surface.vertex_count()));
  std::iota(order.begin(), order.end(), 0);
  // An apex comes before the vertices of its own value, whatever their index.
  const auto key = [&](int v) {
    const bool apex = v >= gradient.mesh_vertex_count;
    return std::tuple(gradient.values[v], gradient.representative[idx(v)], apex ? 0 : 1, v);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  gradient.rank.resize(order.size());
  for (size_t i = 0; i < order.size(); ++i) gradient.rank[idx(order[i])] = static_cast<int>(i);
}

/// The cells of one vertex's lower star, by their place in the vertex's ring: edge i is the i-th
/// outgoing half-edge, face i lies between the edges i and i + 1.
class LowerStar {
 public:
  LowerStar(DiscreteGradient& gradient, int v) : gradient_(gradient) {
    const auto rank = [&](int u) { return gradient.rank[idx(u)]; };
    for_each_outgoing(gradient.surface, v, [&](int h) {
      ring_.push_back(h);
      far_.push_back(rank(gradient.surface.to(h)));
    });
    const int own = rank(v);
    edge_.assign(ring_.size(), State::kOutside);
    face_.assign(ring_.size(), State::kOutside);
    for (size_t i = 0; i < ring_.size(); ++i) {
      if (far_[i] < own) edge_[i] = State::kWaiting;
      if (far_[i] < own && far_[after(i)] < own) face_[i] = State::kWaiting;
    }
  }

  void process(int v) {
    // The steepest edge takes the vertex; without one the vertex is a minimum.
    size_t steepest = ring_.size();
    for (size_t i = 0; i < ring_.size(); ++i)
      if (edge_[i] == State::kWaiting && (steepest == ring_.size() || far_[i] < far_[steepest]))
        steepest = i;
    if (steepest == ring_.size()) {
      gradient_.minima.push_back(v);
      return;
    }
    finish_edge(steepest, EdgeRole::kDescending);
    for (size_t i = 0; i < ring_.size(); ++i)
      if (edge_[i] == State::kWaiting) zero_.insert({key_of_edge(i), false, i});
    offer_faces_at(steepest);
    while (!one_.empty() || !zero_.empty()) {
      if (!one_.empty()) {
        pair_next_face();
      } else {
        make_next_critical();
      }
    }
  }

 private:
  enum class State : std::uint8_t { kOutside, kWaiting, kDone };
  using Key = std::pair<int, int>;
  struct Cell {
    Key key;
    bool is_face;
    size_t i;
    auto operator<=>(const Cell&) const = default;
  };

  [[nodiscard]] size_t after(size_t i) const { return (i + 1) % ring_.size(); }
  [[nodiscard]] size_t before(size_t i) const { return (i + ring_.size() - 1) % ring_.size(); }
  /// Ranks of the corners other than v, descending: the order of Robins et al.'s function G.
  [[nodiscard]] Key key_of_edge(size_t i) const { return {far_[i], -1}; }
  [[nodiscard]] Key key_of_face(size_t i) const {
    return std::minmax(far_[after(i)], far_[i], std::greater<>());
  }

  [[nodiscard]] int waiting_edges(size_t face) const {
    return int(edge_[face] == State::kWaiting) + int(edge_[after(face)] == State::kWaiting);
  }

  void finish_edge(size_t i, EdgeRole role) {
    edge_[i] = State::kDone;
    gradient_.role[idx(ring_[i])] = role;
    gradient_.role[idx(gradient_.surface.twin[idx(ring_[i])])] = role;
  }

  void offer_faces_at(size_t edge) {
    for (const size_t f : {before(edge), edge})
      if (face_[f] == State::kWaiting && waiting_edges(f) == 1)
        one_.insert({key_of_face(f), true, f});
  }

  void pair_next_face() {
    const Cell cell = *one_.begin();
    one_.erase(one_.begin());
    if (waiting_edges(cell.i) == 0) {
      zero_.insert(cell);
      return;
    }
    const size_t edge = edge_[cell.i] == State::kWaiting ? cell.i : after(cell.i);
    face_[cell.i] = State::kDone;
    zero_.erase({key_of_edge(edge), false, edge});
    finish_edge(edge, EdgeRole::kAscending);
    offer_faces_at(edge);
  }

  void make_next_critical() {
    const Cell cell = *zero_.begin();
    zero_.erase(zero_.begin());
    if (cell.is_face) {
      face_[cell.i] = State::kDone;
      gradient_.maxima.push_back(face_of(ring_[cell.i]));
      return;
    }
    finish_edge(cell.i, EdgeRole::kSaddle);
    const int h = ring_[cell.i];
    gradient_.saddles.push_back(std::min(h, gradient_.surface.twin[idx(h)]));
    offer_faces_at(cell.i);
  }

  DiscreteGradient& gradient_;
  std::vector<int> ring_, far_;  ///< outgoing half-edges and the ranks of their ends
  std::vector<State> edge_, face_;
  std::set<Cell> zero_, one_;
};

}  // namespace

Result<DiscreteGradient> discrete_gradient(const TriangleMesh& mesh,
                                           const Eigen::VectorXd& values) {
  if (values.size() != mesh.vertex_count())
    return fail(
        ErrorCode::kBadInput,
        fmt::format("field: {} values for {} vertices", values.size(), mesh.vertex_count()));
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (!std::isfinite(values[v]))
      return fail(ErrorCode::kBadInput,
                  fmt::format("field: value {} at vertex {} is not finite", values[v], v));
  DiscreteGradient gradient;
  if (Status s = close_surface(mesh, values, gradient); !s) return tl::unexpected(s.error());
  rank_vertices(gradient);
  gradient.role.assign(idx(gradient.surface.halfedge_count()), EdgeRole::kSaddle);
  for (int v = 0; v < gradient.surface.vertex_count(); ++v) LowerStar(gradient, v).process(v);
  return gradient;
}

int highest_end(const DiscreteGradient& gradient, int h) {
  const int u = gradient.surface.from(h), w = gradient.surface.to(h);
  return gradient.rank[idx(u)] > gradient.rank[idx(w)] ? u : w;
}

int highest_corner(const DiscreteGradient& gradient, int f) {
  const int u = highest_end(gradient, 3 * f), w = gradient.surface.F(f, 2);
  return gradient.rank[idx(u)] > gradient.rank[idx(w)] ? u : w;
}

GradientForests forests(const DiscreteGradient& gradient) {
  const TriangleMesh& mesh = gradient.surface;
  GradientForests result;
  result.down.assign(idx(mesh.vertex_count()), -1);
  result.minimum.assign(idx(mesh.vertex_count()), -1);
  result.up.assign(idx(mesh.face_count()), -1);
  result.maximum.assign(idx(mesh.face_count()), -1);
  std::vector<int> stack;
  for (const int root : gradient.minima) {
    result.minimum[idx(root)] = root;
    stack.assign(1, root);
    while (!stack.empty()) {
      const int v = stack.back();
      stack.pop_back();
      for_each_outgoing(mesh, v, [&](int h) {
        const int w = mesh.to(h);
        if (gradient.role[idx(h)] != EdgeRole::kDescending || result.minimum[idx(w)] >= 0) return;
        result.minimum[idx(w)] = root;
        result.down[idx(w)] = mesh.twin[idx(h)];
        stack.push_back(w);
      });
    }
  }
  for (const int root : gradient.maxima) {
    result.maximum[idx(root)] = root;
    stack.assign(1, root);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int g = face_of(mesh.twin[idx(h)]);
        if (gradient.role[idx(h)] != EdgeRole::kAscending || result.maximum[idx(g)] >= 0) continue;
        result.maximum[idx(g)] = root;
        result.up[idx(g)] = mesh.twin[idx(h)];
        stack.push_back(g);
      }
    }
  }
  return result;
}

Status validate(const DiscreteGradient& gradient) {
  const TriangleMesh& mesh = gradient.surface;
  const auto broken = [](std::string what) { return fail(ErrorCode::kInternal, std::move(what)); };
  if (!boundary_loops(mesh).empty()) return broken("gradient: surface is not closed");
  int descending = 0, ascending = 0, saddles = 0;
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    if (gradient.role[idx(h)] != gradient.role[idx(mesh.twin[idx(h)])])
      return broken(fmt::format("gradient: half-edge {} and its twin differ in role", h));
    if (mesh.twin[idx(h)] < h) continue;
    descending += gradient.role[idx(h)] == EdgeRole::kDescending ? 1 : 0;
    ascending += gradient.role[idx(h)] == EdgeRole::kAscending ? 1 : 0;
    saddles += gradient.role[idx(h)] == EdgeRole::kSaddle ? 1 : 0;
  }
  const int minima = static_cast<int>(gradient.minima.size());
  const int maxima = static_cast<int>(gradient.maxima.size());
  const auto roots = forests(gradient);
  const bool reached = std::count(roots.minimum.begin(), roots.minimum.end(), -1) == 0 &&
                       std::count(roots.maximum.begin(), roots.maximum.end(), -1) == 0;
  // Spanning and of the right number of edges: a forest with one root in each tree.
  if (!reached || descending != mesh.vertex_count() - minima ||
      ascending != mesh.face_count() - maxima)
    return broken("gradient: the edges of one role are not a spanning forest");
  if (saddles != static_cast<int>(gradient.saddles.size()) ||
      minima - saddles + maxima != euler_characteristic(mesh))
    return broken(fmt::format("gradient: {} minima, {} saddles, {} maxima do not add up to {}",
                              minima,
                              saddles,
                              maxima,
                              euler_characteristic(mesh)));
  return {};
}

}  // namespace crosspatch
