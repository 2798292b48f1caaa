#include "param/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "core/index.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// The arc of saddle number s that leaves over the vertex from(h), h a half-edge of its edge.
int descending_arc(int s, bool lower) {
  return 4 * s + (lower ? 2 : 0);
}
/// The arc of saddle number s that leaves over the face of h.
int ascending_arc(int s, bool lower) {
  return 4 * s + (lower ? 1 : 3);
}

/// Saddle number per half-edge of a saddle edge.
std::map<int, int> saddle_numbers(const DiscreteGradient& gradient) {
  std::map<int, int> number;
  for (size_t s = 0; s < gradient.saddles.size(); ++s) {
    const int h = gradient.saddles[s];
    number[h] = number[gradient.surface.twin[idx(h)]] = static_cast<int>(s);
  }
  return number;
}

/// Arcs that end at a minimum, counter-clockwise: a walk around the tree of descending edges.
std::vector<int> arcs_at_minimum(const DiscreteGradient& gradient,
                                 const std::map<int, int>& number,
                                 int vertex) {
  const std::vector<int>& twin = gradient.surface.twin;
  std::vector<int> arcs;
  const int start = gradient.surface.out[idx(vertex)];
  int h = start;
  do {
    const EdgeRole role = gradient.role[idx(h)];
    if (role == EdgeRole::kSaddle) arcs.push_back(descending_arc(number.at(h), h < twin[idx(h)]));
    h = twin[idx(prev(role == EdgeRole::kDescending ? twin[idx(h)] : h))];
  } while (h != start);
  return arcs;
}

/// Arcs that end at a maximum, counter-clockwise: a walk around the tree of ascending faces.
std::vector<int> arcs_at_maximum(const DiscreteGradient& gradient,
                                 const std::map<int, int>& number,
                                 int face) {
  const std::vector<int>& twin = gradient.surface.twin;
  std::vector<int> arcs;
  const int start = 3 * face;
  int h = start;
  do {
    const EdgeRole role = gradient.role[idx(h)];
    if (role == EdgeRole::kSaddle) arcs.push_back(ascending_arc(number.at(h), h < twin[idx(h)]));
    h = next(role == EdgeRole::kAscending ? twin[idx(h)] : h);
  } while (h != start);
  return arcs;
}

double node_value(const DiscreteGradient& gradient, NodeKind kind, int cell) {
  if (kind == NodeKind::kMinimum) return gradient.values[cell];
  return gradient.values[kind == NodeKind::kSaddle ? highest_end(gradient, cell)
                                                   : highest_corner(gradient, cell)];
}

int node_vertex(const DiscreteGradient& gradient, NodeKind kind, int cell) {
  const int v = kind == NodeKind::kMinimum  ? cell
                : kind == NodeKind::kSaddle ? highest_end(gradient, cell)
                                            : highest_corner(gradient, cell);
  return gradient.representative[idx(v)];
}

bool is_kept(const DiscreteGradient& gradient,
             NodeKind kind,
             int cell,
             const std::vector<KeptNode>& kept) {
  const int v = node_vertex(gradient, kind, cell);
  return std::any_of(
      kept.begin(), kept.end(), [&](const KeptNode& k) { return k.kind == kind && k.vertex == v; });
}

void link_faces(QuadLayout& layout) {
  const int darts = static_cast<int>(layout.node.size());
  std::vector<int> before(idx(darts), -1);
  for (int d = 0; d < darts; ++d) before[idx(layout.sigma[idx(d)])] = d;
  layout.phi.resize(idx(darts));
  for (int d = 0; d < darts; ++d) layout.phi[idx(d)] = before[idx(QuadLayout::twin(d))];
  layout.face.assign(idx(darts), -1);
  for (int d = 0; d < darts; ++d) {
    if (layout.face[idx(d)] >= 0) continue;
    for (int e = d; layout.face[idx(e)] < 0; e = layout.phi[idx(e)])
      layout.face[idx(e)] = layout.face_count;
    ++layout.face_count;
  }
}

/// Trees of the gradient during pruning: one extremum each, or none if it was cancelled.
struct Forest {
  NodeKind kind;
  std::vector<int> parent;     ///< union-find over the extrema's numbers
  std::vector<int> extremum;   ///< per root of the union-find: number of the extremum left
  std::vector<int> cells;      ///< per number
  std::vector<double> values;  ///< per number, on the scale
  std::vector<bool> kept;      ///< per number

  int root(int i) {
    while (parent[idx(i)] != i) i = parent[idx(i)] = parent[idx(parent[idx(i)])];
    return i;
  }
};

Result<double> on_scale(double value, FieldScale scale) {
  if (scale == FieldScale::kLinear) return value;
  if (!(value > 0))
    return fail(ErrorCode::kBadInput, fmt::format("layout: logarithm of the value {}", value));
  return std::log(value);
}

Result<Forest> make_forest(const DiscreteGradient& gradient,
                           NodeKind kind,
                           const std::vector<KeptNode>& kept,
                           FieldScale scale) {
  Forest f{kind, {}, {}, kind == NodeKind::kMinimum ? gradient.minima : gradient.maxima, {}, {}};
  f.parent.resize(f.cells.size());
  std::iota(f.parent.begin(), f.parent.end(), 0);
  f.extremum = f.parent;
  for (const int cell : f.cells) {
    const auto value = on_scale(node_value(gradient, kind, cell), scale);
    if (!value) return tl::unexpected(value.error());
    f.values.push_back(*value);
    f.kept.push_back(is_kept(gradient, kind, cell, kept));
  }
  return f;
}

/// A saddle edge during pruning: the numbers of the trees at its two ends, in each forest.
struct Candidate {
  int saddle;
  double value;
  std::array<std::array<int, 2>, 2> ends;
};

struct Choice {
  double cost = std::numeric_limits<double>::infinity();
  size_t candidate = 0;
  size_t forest = 0;
  size_t end = 0;  ///< the extremum at this end goes
};

Choice cheapest(const std::vector<Candidate>& candidates, std::array<Forest, 2>& forests) {
  Choice best;
  for (size_t c = 0; c < candidates.size(); ++c)
    for (size_t f = 0; f < 2; ++f) {
      const int a = forests[f].root(candidates[c].ends[f][0]);
      const int b = forests[f].root(candidates[c].ends[f][1]);
      if (a == b) continue;
      for (size_t end = 0; end < 2; ++end) {
        const int e = forests[f].extremum[idx(end == 0 ? a : b)];
        const double cost = std::abs(candidates[c].value - forests[f].values[idx(e)]);
        if (!forests[f].kept[idx(e)] && cost < best.cost) best = {cost, c, f, end};
      }
    }
  return best;
}

Status check_kept(const DiscreteGradient& gradient, const std::vector<KeptNode>& kept) {
  for (const KeptNode& k : kept) {
    const std::vector<int>& cells = k.kind == NodeKind::kMinimum  ? gradient.minima
                                    : k.kind == NodeKind::kSaddle ? gradient.saddles
                                                                  : gradient.maxima;
    if (std::none_of(cells.begin(), cells.end(), [&](int cell) {
          return node_vertex(gradient, k.kind, cell) == k.vertex;
        }))
      return fail(ErrorCode::kBadInput,
                  fmt::format("layout: vertex {} is no node of the kind to be kept", k.vertex));
  }
  return {};
}

}  // namespace

Result<QuadLayout> quad_layout(const DiscreteGradient& gradient) {
  QuadLayout layout;
  const auto add_nodes = [&](NodeKind kind, const std::vector<int>& cells) {
    for (const int cell : cells)
      layout.nodes.push_back({kind, cell, node_value(gradient, kind, cell), false});
  };
  add_nodes(NodeKind::kSaddle, gradient.saddles);
  add_nodes(NodeKind::kMinimum, gradient.minima);
  add_nodes(NodeKind::kMaximum, gradient.maxima);
  const std::map<int, int> number = saddle_numbers(gradient);
  const size_t darts = 8 * gradient.saddles.size();
  layout.node.assign(darts, -1);
  layout.sigma.assign(darts, -1);
  for (int d = 0; d < static_cast<int>(darts); d += 2) {
    layout.node[idx(d)] = d / 8;
    layout.sigma[idx(d)] = d - d % 8 + (d + 2) % 8;
  }
  for (int s = 0; s < static_cast<int>(gradient.saddles.size()); ++s)
    layout.first_dart.push_back(8 * s);
  for (size_t n = gradient.saddles.size(); n < layout.nodes.size(); ++n) {
    const LayoutNode& node = layout.nodes[n];
    const std::vector<int> arcs = node.kind == NodeKind::kMinimum
                                      ? arcs_at_minimum(gradient, number, node.cell)
                                      : arcs_at_maximum(gradient, number, node.cell);
    if (arcs.empty())
      return fail(ErrorCode::kNoCorrespondence,
                  fmt::format("layout: an extremum of value {} has no arc", node.value));
    layout.first_dart.push_back(2 * arcs.front() + 1);
    for (size_t i = 0; i < arcs.size(); ++i) {
      layout.node[idx(2 * arcs[i] + 1)] = static_cast<int>(n);
      layout.sigma[idx(2 * arcs[i] + 1)] = 2 * arcs[(i + 1) % arcs.size()] + 1;
    }
  }
  link_faces(layout);
  return layout;
}

Status validate(const QuadLayout& layout, int euler) {
  const auto broken = [](std::string what) {
    return fail(ErrorCode::kInternal, "layout: " + std::move(what));
  };
  const int darts = static_cast<int>(layout.node.size());
  std::vector<int> first(layout.nodes.size(), -1), count(layout.nodes.size(), 0);
  std::vector<int> hits(idx(darts), 0);
  for (int d = 0; d < darts; ++d) {
    const int n = layout.node[idx(d)], after = layout.sigma[idx(d)];
    if (n < 0 || n >= static_cast<int>(layout.nodes.size()) || after < 0 || after >= darts ||
        layout.node[idx(after)] != n || hits[idx(after)]++ > 0)
      return broken(fmt::format("sigma is no rotation at dart {}", d));
    if (layout.sigma[idx(layout.phi[idx(d)])] != QuadLayout::twin(d))
      return broken(fmt::format("phi does not fit sigma at dart {}", d));
    if (layout.face[idx(layout.phi[idx(d)])] != layout.face[idx(d)])
      return broken(fmt::format("face of dart {} changes along phi", d));
    first[idx(n)] = d;
    ++count[idx(n)];
  }
  for (size_t n = 0; n < layout.nodes.size(); ++n) {
    int length = 0;
    for (int d = first[n]; d >= 0 && (length == 0 || d != first[n]); d = layout.sigma[idx(d)])
      ++length;
    if (length == 0 || length != count[n])
      return broken(fmt::format("node {} has {} darts in {} of one cycle", n, count[n], length));
  }
  for (int f = 0; f < layout.face_count; ++f)
    if (const size_t n = darts_of_face(layout, f).size(); n != 4)
      return broken(fmt::format("face {} has {} sides", f, n));
  if (layout.face_count != 2 * layout.saddle_count())
    return broken(fmt::format("{} faces for {} saddles", layout.face_count, layout.saddle_count()));
  const int sum = static_cast<int>(layout.nodes.size()) - layout.arc_count() + layout.face_count;
  if (sum != euler) return broken(fmt::format("Euler sum {} is not {}", sum, euler));
  return {};
}

std::vector<int> darts_of_face(const QuadLayout& layout, int face) {
  const auto at = std::find(layout.face.begin(), layout.face.end(), face);
  std::vector<int> darts;
  if (at == layout.face.end()) return darts;
  const int first = static_cast<int>(at - layout.face.begin());
  for (int d = first; darts.empty() || d != first; d = layout.phi[idx(d)]) darts.push_back(d);
  return darts;
}

Result<DiscreteGradient> prune_to(DiscreteGradient gradient,
                                  const std::vector<KeptNode>& kept,
                                  FieldScale scale) {
  if (Status s = check_kept(gradient, kept); !s) return tl::unexpected(s.error());
  auto minima = make_forest(gradient, NodeKind::kMinimum, kept, scale);
  if (!minima) return tl::unexpected(minima.error());
  auto maxima = make_forest(gradient, NodeKind::kMaximum, kept, scale);
  if (!maxima) return tl::unexpected(maxima.error());
  std::array<Forest, 2> trees{std::move(*minima), std::move(*maxima)};
  const GradientForests roots = forests(gradient);
  std::array<std::map<int, int>, 2> number;
  for (size_t f = 0; f < 2; ++f)
    for (size_t i = 0; i < trees[f].cells.size(); ++i)
      number[f][trees[f].cells[i]] = static_cast<int>(i);
  std::vector<Candidate> candidates;
  for (const int h : gradient.saddles) {
    if (is_kept(gradient, NodeKind::kSaddle, h, kept)) continue;
    const int t = gradient.surface.twin[idx(h)];
    const auto minimum = [&](int g) {
      return number[0].at(roots.minimum[idx(gradient.surface.from(g))]);
    };
    const auto maximum = [&](int g) { return number[1].at(roots.maximum[idx(face_of(g))]); };
    candidates.push_back({h,
                          *on_scale(node_value(gradient, NodeKind::kSaddle, h), scale),
                          {{{minimum(h), minimum(t)}, {maximum(h), maximum(t)}}}});
  }
  const auto drop = [](std::vector<int>& from, int value) {
    from.erase(std::find(from.begin(), from.end(), value));
  };
  // The last saddle stays: without one there is no layout.
  for (Choice best = cheapest(candidates, trees);
       std::isfinite(best.cost) && gradient.saddles.size() > 1;
       best = cheapest(candidates, trees)) {
    const Candidate chosen = candidates[best.candidate];
    Forest& forest = trees[best.forest];
    const int gone = forest.root(chosen.ends[best.forest][best.end]);
    const int stays = forest.root(chosen.ends[best.forest][1 - best.end]);
    drop(best.forest == 0 ? gradient.minima : gradient.maxima,
         forest.cells[idx(forest.extremum[idx(gone)])]);
    forest.parent[idx(gone)] = stays;
    drop(gradient.saddles, chosen.saddle);
    gradient.role[idx(chosen.saddle)] =
        gradient.role[idx(gradient.surface.twin[idx(chosen.saddle)])] =
            best.forest == 0 ? EdgeRole::kDescending : EdgeRole::kAscending;
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best.candidate));
  }
  return gradient;
}

void mark_free_nodes(QuadLayout& layout,
                     const DiscreteGradient& gradient,
                     const std::vector<KeptNode>& kept) {
  for (LayoutNode& node : layout.nodes) node.free = !is_kept(gradient, node.kind, node.cell, kept);
}

}  // namespace crosspatch
