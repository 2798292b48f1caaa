#include "core/feature_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>

#include "core/heat_flow.hpp"
#include "core/index.hpp"

namespace crosspatch {
namespace {

/// The order of a function's vertices, ties by index.
std::vector<int> ranks(const Eigen::VectorXd& values) {
  std::vector<int> order(idx(values.size())), rank(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(values[a], a) < std::pair(values[b], b);
  });
  for (size_t i = 0; i < order.size(); ++i) rank[idx(order[i])] = static_cast<int>(i);
  return rank;
}

/// Which vertices paths of rising (or falling) rank reach, from many starts at once: bit i of a
/// vertex tells whether start i reaches it.
class MonotoneReach {
 public:
  MonotoneReach(const TriangleMesh& mesh,
                const std::vector<int>& rank,
                const std::vector<int>& starts)
      : words_((starts.size() + 63) / 64), bits_(rank.size() * words_, 0) {
    for (size_t i = 0; i < starts.size(); ++i) word(starts[i], i / 64) |= bit(i);
    std::vector<int> order(rank.size());
    for (size_t v = 0; v < rank.size(); ++v) order[idx(rank[v])] = static_cast<int>(v);
    for (const int v : order)
      for_each_neighbour(mesh, v, [&](int u) {
        if (rank[idx(u)] < rank[idx(v)]) return;
        for (size_t w = 0; w < words_; ++w) word(u, w) |= word(v, w);
      });
  }

  [[nodiscard]] bool reaches(size_t start, int v) {
    return (word(v, start / 64) & bit(start)) != 0;
  }

  template <class Visit>
  static void for_each_neighbour(const TriangleMesh& mesh, int v, Visit&& visit) {
    for_each_outgoing(mesh, v, [&](int h) {
      visit(mesh.to(h));
      // The last edge of a boundary fan has no half-edge that leaves v.
      if (mesh.twin[idx(prev(h))] < 0) visit(mesh.tip(h));
    });
  }

 private:
  static std::uint64_t bit(size_t i) { return std::uint64_t{1} << (i % 64); }
  std::uint64_t& word(int v, size_t w) { return bits_[idx(v) * words_ + w]; }

  size_t words_;
  std::vector<std::uint64_t> bits_;
};

/// A shortest (in edges) path of rising rank from `start` to `end`, which it must reach.
std::vector<int> monotone_path(const TriangleMesh& mesh,
                               const std::vector<int>& rank,
                               int start,
                               int end) {
  std::map<int, int> parent{{start, start}};
  std::vector<int> queue{start};
  for (size_t i = 0; i < queue.size() && !parent.contains(end); ++i)
    MonotoneReach::for_each_neighbour(mesh, queue[i], [&](int u) {
      if (rank[idx(u)] > rank[idx(queue[i])] && parent.emplace(u, queue[i]).second)
        queue.push_back(u);
    });
  std::vector<int> path{end};
  while (path.back() != start) path.push_back(parent.at(path.back()));
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<int> nodes_of(const MorseSmaleComplex& complex, NodeKind kind) {
  std::vector<int> nodes;
  for (int i = 0; i < static_cast<int>(complex.nodes.size()); ++i)
    if (complex.nodes[idx(i)].kind == kind) nodes.push_back(i);
  return nodes;
}

/// Adds arcs of `weight` between saddles and extrema of `kind` that rising paths of `values` join;
/// for minima `values` must be the function's negative.
void add_paths(const TriangleMesh& mesh,
               const Eigen::VectorXd& values,
               NodeKind kind,
               double weight,
               Eigen::MatrixXi& joined,
               FeatureGraph& graph) {
  const std::vector<int> rank = ranks(values);
  const std::vector<int> saddles = nodes_of(graph.complex, NodeKind::kSaddle);
  std::vector<int> starts;
  for (const int s : saddles) starts.push_back(graph.node(s).vertex);
  MonotoneReach reach(mesh, rank, starts);
  for (size_t i = 0; i < saddles.size(); ++i)
    for (const int e : nodes_of(graph.complex, kind)) {
      const double rise = graph.node(e).value - graph.node(saddles[i]).value;
      if (joined(saddles[i], e) != 0 || (kind == NodeKind::kMaximum ? rise : -rise) < 0 ||
          !reach.reaches(i, graph.node(e).vertex))
        continue;
      joined(saddles[i], e) = 1;
      graph.arcs.push_back(
          {saddles[i], e, weight, monotone_path(mesh, rank, starts[i], graph.node(e).vertex)});
    }
}

/// Orders paths that start at one vertex counter-clockwise: they form a tree that branches where
/// two paths part, and its leaves are met in the order of the edges around each branching vertex.
class PathTree {
 public:
  explicit PathTree(const TriangleMesh& mesh) : mesh_(mesh), tree_(1) {}

  void insert(const std::vector<int>& path, int arc) {
    int at = 0;
    tree_[0].vertex = path.front();
    for (size_t i = 1; i < path.size(); ++i) {
      auto& children = tree_[idx(at)].children;
      const auto [child, fresh] = children.try_emplace(path[i], static_cast<int>(tree_.size()));
      const int next_at = child->second;
      if (fresh) tree_.push_back({path[i], {}, {}});
      at = next_at;
    }
    tree_[idx(at)].arcs.push_back(arc);
  }

  [[nodiscard]] std::vector<int> order() const {
    std::vector<int> arcs;
    visit(0, -1, arcs);
    return arcs;
  }

 private:
  struct Branch {
    int vertex = -1;
    std::map<int, int> children;  ///< by vertex
    std::vector<int> arcs;        ///< that end here
  };

  void visit(int at, int came_from, std::vector<int>& arcs) const {
    const Branch& branch = tree_[idx(at)];
    arcs.insert(arcs.end(), branch.arcs.begin(), branch.arcs.end());
    if (branch.children.empty()) return;
    std::vector<int> ring;
    MonotoneReach::for_each_neighbour(mesh_, branch.vertex, [&](int u) { ring.push_back(u); });
    if (const auto start = std::find(ring.begin(), ring.end(), came_from); start != ring.end())
      std::rotate(ring.begin(), start, ring.end());
    for (const int u : ring)
      if (const auto child = branch.children.find(u); child != branch.children.end())
        visit(child->second, branch.vertex, arcs);
    // Jumps along a boundary loop (see MorseArc::path) have no place in the ring.
    for (const auto& [u, child] : branch.children)
      if (std::find(ring.begin(), ring.end(), u) == ring.end()) visit(child, branch.vertex, arcs);
  }

  const TriangleMesh& mesh_;
  std::vector<Branch> tree_;
};

/// The complex's own rotation with each further arc behind the arc that precedes it in the order of
/// the paths.
std::vector<std::vector<int>> make_rotation(const TriangleMesh& mesh, const FeatureGraph& graph) {
  const int own = static_cast<int>(graph.complex.arcs.size());
  std::vector<PathTree> trees(idx(graph.node_count()), PathTree(mesh));
  for (int a = 0; a < static_cast<int>(graph.arcs.size()); ++a) {
    std::vector<int> path = graph.arcs[idx(a)].path;
    trees[idx(graph.arcs[idx(a)].saddle)].insert(path, a);
    std::reverse(path.begin(), path.end());
    trees[idx(graph.arcs[idx(a)].extremum)].insert(path, a);
  }
  std::vector<std::vector<int>> rotation;
  for (int n = 0; n < graph.node_count(); ++n) {
    std::vector<int> around = graph.node(n).arcs;
    if (const std::vector<int> order = trees[idx(n)].order(); order.size() > around.size()) {
      // Begin behind an arc of the complex, if there is any, so that each has a predecessor.
      size_t first = 0;
      while (first < order.size() && order[first] >= own) ++first;
      first %= order.size();
      auto place = around.begin();
      for (size_t i = 0; i < order.size(); ++i) {
        const int arc = order[(first + i) % order.size()];
        if (arc < own) {
          place = std::find(around.begin(), around.end(), arc) + 1;
        } else {
          place = around.insert(place, arc) + 1;
        }
      }
    }
    rotation.push_back(std::move(around));
  }
  return rotation;
}

}  // namespace

Result<FeatureGraph> build_feature_graph(const TriangleMesh& mesh,
                                         const Eigen::VectorXd& adf,
                                         double lambda_1,
                                         const FeatureGraphOptions& options) {
  auto complex = morse_smale_complex(mesh, adf, options.complex);
  if (!complex) return tl::unexpected(complex.error());
  const auto series =
      heat_flow_series(mesh, adf, options.smoothing_step / lambda_1, options.levels);
  if (!series) return tl::unexpected(series.error());
  FeatureGraph graph{std::move(*complex), {}, {}};
  Eigen::MatrixXi joined = Eigen::MatrixXi::Zero(graph.node_count(), graph.node_count());
  for (const MorseArc& arc : graph.complex.arcs) {
    graph.arcs.push_back({arc.saddle, arc.extremum, 1, arc.path});
    joined(arc.saddle, arc.extremum) = 1;
  }
  for (int k = 0; k < options.levels; ++k) {
    const double weight = static_cast<double>(options.levels - k) / options.levels;  // Eq. (2)
    add_paths(mesh, series->col(k), NodeKind::kMaximum, weight, joined, graph);
    add_paths(mesh, -series->col(k), NodeKind::kMinimum, weight, joined, graph);
  }
  graph.rotation = make_rotation(mesh, graph);
  return graph;
}

Status validate(const FeatureGraph& graph) {
  const auto broken = [](std::string what) { return fail(ErrorCode::kInternal, std::move(what)); };
  const size_t own = graph.complex.arcs.size();
  if (graph.arcs.size() < own || graph.rotation.size() != graph.complex.nodes.size())
    return broken("feature graph: sizes differ");
  std::vector<int> ends(graph.arcs.size(), 0);
  for (int n = 0; n < graph.node_count(); ++n) {
    std::vector<int> around;
    for (const int a : graph.rotation[idx(n)]) {
      ++ends[idx(a)];
      if (graph.arcs[idx(a)].saddle != n && graph.arcs[idx(a)].extremum != n)
        return broken(fmt::format("feature graph: arc {} is not at node {}", a, n));
      if (idx(a) < own) around.push_back(a);
    }
    const std::vector<int>& exact = graph.node(n).arcs;
    if (!exact.empty())
      std::rotate(around.begin(), std::find(around.begin(), around.end(), exact[0]), around.end());
    if (around != exact)
      return broken(fmt::format("feature graph: node {} turns unlike its complex", n));
  }
  for (size_t a = 0; a < graph.arcs.size(); ++a) {
    const FeatureArc& arc = graph.arcs[a];
    if (ends[a] != 2) return broken(fmt::format("feature graph: arc {} has {} ends", a, ends[a]));
    if (!(arc.weight > 0 && arc.weight <= 1) || (a < own && arc.weight != 1))
      return broken(fmt::format("feature graph: arc {} has weight {}", a, arc.weight));
    for (size_t b = 0; a >= own && b < a; ++b)
      if (graph.arcs[b].saddle == arc.saddle && graph.arcs[b].extremum == arc.extremum)
        return broken(fmt::format("feature graph: arc {} repeats arc {}", a, b));
  }
  return {};
}

Eigen::MatrixXd adjacency(const FeatureGraph& graph) {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(graph.node_count(), graph.node_count());
  for (const FeatureArc& arc : graph.arcs) {
    const double w = std::max(weights(arc.saddle, arc.extremum), arc.weight);
    weights(arc.saddle, arc.extremum) = weights(arc.extremum, arc.saddle) = w;
  }
  return weights;
}

}  // namespace crosspatch
