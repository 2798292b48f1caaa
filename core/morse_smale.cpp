#include "core/morse_smale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Keeps the first visit of each vertex and cuts out the loop up to a second one.
std::vector<int> without_loops(const std::vector<int>& path) {
  std::vector<int> result;
  std::unordered_map<int, size_t> place;
  for (const int v : path) {
    const auto seen = place.find(v);
    if (seen == place.end()) {
      place.emplace(v, result.size());
      result.push_back(v);
      continue;
    }
    for (size_t i = seen->second + 1; i < result.size(); ++i) place.erase(result[i]);
    result.resize(seen->second + 1);
  }
  return result;
}

/// Reads nodes, arcs and rotations off a gradient. The arcs of the saddle with the half-edges h and
/// twin t: descending[h] leaves over from(h), ascending[h] over the face of h; likewise for t.
class Extraction {
 public:
  Extraction(const DiscreteGradient& gradient, const PersistenceHierarchy& hierarchy)
      : gradient_(gradient), mesh_(gradient.surface), forests_(forests(gradient)) {
    for (const Cancellation& c : hierarchy.order) {
      persistence_[{NodeKind::kSaddle, c.saddle}] = c.persistence;
      persistence_[{c.kind, c.extremum}] = c.persistence;
    }
  }

  MorseSmaleComplex run() {
    add_nodes(NodeKind::kMaximum, gradient_.maxima);
    add_nodes(NodeKind::kSaddle, gradient_.saddles);
    add_nodes(NodeKind::kMinimum, gradient_.minima);
    for (size_t i = 0; i < result_.nodes.size(); ++i)
      if (result_.nodes[i].kind == NodeKind::kSaddle) add_arcs(static_cast<int>(i));
    for (size_t i = 0; i < result_.nodes.size(); ++i) {
      if (result_.nodes[i].kind == NodeKind::kMinimum) turn_around_minimum(static_cast<int>(i));
      if (result_.nodes[i].kind == NodeKind::kMaximum) turn_around_maximum(static_cast<int>(i));
    }
    add_cells();
    return std::move(result_);
  }

 private:
  using CellKey = std::pair<NodeKind, int>;

  [[nodiscard]] int twin(int h) const { return mesh_.twin[idx(h)]; }

  [[nodiscard]] int vertex_of(NodeKind kind, int cell) const {
    if (kind == NodeKind::kMinimum) return cell;
    return kind == NodeKind::kSaddle ? highest_end(gradient_, cell)
                                     : highest_corner(gradient_, cell);
  }

  void add_nodes(NodeKind kind, std::vector<int> cells) {
    const auto rank = [&](int cell) { return gradient_.rank[idx(vertex_of(kind, cell))]; };
    std::sort(cells.begin(), cells.end(), [&](int a, int b) {
      return std::pair(-rank(a), a) < std::pair(-rank(b), b);
    });
    for (const int cell : cells) {
      MorseNode node;
      node.kind = kind;
      const int v = vertex_of(kind, cell);
      node.vertex = gradient_.representative[idx(v)];
      node.value = gradient_.values[v];
      if (const auto p = persistence_.find({kind, cell}); p != persistence_.end())
        node.persistence = p->second;
      node_at_[{kind, cell}] = static_cast<int>(result_.nodes.size());
      cell_of_.push_back(cell);
      result_.nodes.push_back(std::move(node));
    }
  }

  void add_arcs(int saddle) {
    const int h = cell_of_[idx(saddle)], t = twin(h);
    // Counter-clockwise around the edge's middle: ahead, left, behind, right of h.
    for (const int side : {t, h}) {
      const int minimum = forests_.minimum[idx(mesh_.from(side))];
      descending_[side] = add_arc(saddle, node_at_.at({NodeKind::kMinimum, minimum}), down(side));
      const int maximum = forests_.maximum[idx(face_of(twin(side)))];
      ascending_[twin(side)] =
          add_arc(saddle, node_at_.at({NodeKind::kMaximum, maximum}), up(twin(side)));
    }
  }

  int add_arc(int saddle, int extremum, std::vector<int> path) {
    for (int& v : path) v = gradient_.representative[idx(v)];
    const int arc = static_cast<int>(result_.arcs.size());
    result_.arcs.push_back({saddle, extremum, without_loops(path)});
    result_.nodes[idx(saddle)].arcs.push_back(arc);
    return arc;
  }

  [[nodiscard]] std::vector<int> down(int h) const {
    std::vector<int> path{highest_end(gradient_, h)};
    int v = mesh_.from(h);
    path.push_back(v);
    for (int step = forests_.down[idx(v)]; step >= 0; step = forests_.down[idx(v)]) {
      v = mesh_.to(step);
      path.push_back(v);
    }
    return path;
  }

  /// Through the highest ends of the edges crossed: two in a row lie in one triangle.
  [[nodiscard]] std::vector<int> up(int h) const {
    std::vector<int> path{highest_end(gradient_, h)};
    int f = face_of(h);
    for (int step = forests_.up[idx(f)]; step >= 0; step = forests_.up[idx(f)]) {
      path.push_back(highest_end(gradient_, step));
      f = face_of(twin(step));
    }
    path.push_back(highest_corner(gradient_, f));
    return path;
  }

  /// Walks counter-clockwise around the root's tree and notes the saddle edges that end at it.
  void turn_around_minimum(int node) {
    const auto turn = [&](int h) { return twin(prev(h)); };  // next outgoing half-edge
    const int start = mesh_.out[idx(cell_of_[idx(node)])];
    int h = start;
    do {
      if (gradient_.role[idx(h)] == EdgeRole::kSaddle) finish_arc(node, descending_.at(h));
      h = turn(gradient_.role[idx(h)] == EdgeRole::kDescending ? twin(h) : h);
    } while (h != start);
  }

  void turn_around_maximum(int node) {
    const int start = 3 * cell_of_[idx(node)];
    int h = start;
    do {
      if (gradient_.role[idx(h)] == EdgeRole::kSaddle) finish_arc(node, ascending_.at(h));
      h = next(gradient_.role[idx(h)] == EdgeRole::kAscending ? twin(h) : h);
    } while (h != start);
  }

  void finish_arc(int node, int arc) { result_.nodes[idx(node)].arcs.push_back(arc); }

  /// Follows the faces of the rotation system, keeping each on the left: arrived at a node over an
  /// arc, the next side is the arc before it in counter-clockwise order.
  void add_cells() {
    const auto before = [&](int node, int arc) {
      const std::vector<int>& arcs = result_.nodes[idx(node)].arcs;
      const auto i = std::find(arcs.begin(), arcs.end(), arc);
      return i == arcs.begin() ? arcs.back() : *(i - 1);
    };
    const auto other_end = [&](int node, int arc) {
      return result_.arcs[idx(arc)].saddle == node ? result_.arcs[idx(arc)].extremum
                                                   : result_.arcs[idx(arc)].saddle;
    };
    for (int first = 0; first < static_cast<int>(result_.arcs.size()); ++first) {
      const MorseArc& arc = result_.arcs[idx(first)];
      if (result_.nodes[idx(arc.extremum)].kind != NodeKind::kMaximum) continue;
      MorseCell cell;
      int node = arc.saddle, side = first;
      for (size_t i = 0; i < 4; ++i) {
        cell.nodes[i] = node;
        cell.arcs[i] = side;
        node = other_end(node, side);
        side = before(node, side);
      }
      result_.cells.push_back(cell);
    }
  }

  const DiscreteGradient& gradient_;
  const TriangleMesh& mesh_;
  GradientForests forests_;
  std::map<CellKey, double> persistence_;
  std::map<CellKey, int> node_at_;
  std::vector<int> cell_of_;  ///< per node
  std::unordered_map<int, int> descending_, ascending_;
  MorseSmaleComplex result_;
};

Status check_node(const MorseSmaleComplex& complex, int i) {
  const MorseNode& node = complex.nodes[idx(i)];
  const auto kind_over = [&](size_t k) {
    return complex.nodes[idx(complex.arcs[idx(node.arcs[k])].extremum)].kind;
  };
  if (node.kind == NodeKind::kSaddle &&
      (node.arcs.size() != 4 || kind_over(0) != kind_over(2) || kind_over(1) != kind_over(3) ||
       kind_over(0) == kind_over(1)))
    return fail(ErrorCode::kInternal, fmt::format("complex: saddle {} has no proper cross", i));
  for (const int arc : node.arcs) {
    const MorseArc& a = complex.arcs[idx(arc)];
    const int own = node.kind == NodeKind::kSaddle ? a.saddle : a.extremum;
    if (own != i || std::count(node.arcs.begin(), node.arcs.end(), arc) != 1)
      return fail(ErrorCode::kInternal, fmt::format("complex: node {} lists arc {}", i, arc));
  }
  return {};
}

Status check_cell(const MorseSmaleComplex& complex, int i) {
  const MorseCell& cell = complex.cells[idx(i)];
  constexpr std::array<NodeKind, 4> kKinds{
      NodeKind::kSaddle, NodeKind::kMaximum, NodeKind::kSaddle, NodeKind::kMinimum};
  for (size_t k = 0; k < 4; ++k) {
    const MorseArc& arc = complex.arcs[idx(cell.arcs[k])];
    const int a = cell.nodes[k], b = cell.nodes[(k + 1) % 4];
    if (complex.nodes[idx(a)].kind != kKinds[k] ||
        !(std::pair(a, b) == std::pair(arc.saddle, arc.extremum) ||
          std::pair(b, a) == std::pair(arc.saddle, arc.extremum)))
      return fail(ErrorCode::kInternal, fmt::format("complex: cell {} is not a 4-cycle", i));
    const std::vector<int>& around = complex.nodes[idx(b)].arcs;
    const auto in = std::find(around.begin(), around.end(), cell.arcs[k]);
    if ((in == around.begin() ? around.back() : *(in - 1)) != cell.arcs[(k + 1) % 4])
      return fail(ErrorCode::kInternal,
                  fmt::format("complex: cell {} does not turn with node {}", i, b));
  }
  return {};
}

}  // namespace

int MorseSmaleComplex::count(NodeKind kind) const {
  return static_cast<int>(std::count_if(
      nodes.begin(), nodes.end(), [&](const MorseNode& node) { return node.kind == kind; }));
}

MorseSmaleComplex morse_smale_complex(const DiscreteGradient& gradient,
                                      const PersistenceHierarchy& hierarchy) {
  return Extraction(gradient, hierarchy).run();
}

Result<MorseSmaleComplex> morse_smale_complex(const TriangleMesh& mesh,
                                              const Eigen::VectorXd& values,
                                              const MorseSmaleOptions& options) {
  auto gradient = discrete_gradient(mesh, values);
  if (!gradient) return tl::unexpected(gradient.error());
  const auto hierarchy = persistence_hierarchy(*gradient, options.scale);
  if (!hierarchy) return tl::unexpected(hierarchy.error());
  return morse_smale_complex(simplify(std::move(*gradient), *hierarchy, options.threshold),
                             *hierarchy);
}

Status validate(const MorseSmaleComplex& complex, int euler) {
  const int saddles = complex.count(NodeKind::kSaddle);
  const int sum = complex.count(NodeKind::kMinimum) - saddles + complex.count(NodeKind::kMaximum);
  if (sum != euler)
    return fail(ErrorCode::kInternal, fmt::format("complex: Euler sum {} is not {}", sum, euler));
  if (complex.arcs.size() != 4 * idx(saddles) || complex.cells.size() != 2 * idx(saddles))
    return fail(ErrorCode::kInternal,
                fmt::format("complex: {} arcs and {} cells for {} saddles",
                            complex.arcs.size(),
                            complex.cells.size(),
                            saddles));
  size_t ends = 0;
  for (int i = 0; i < static_cast<int>(complex.nodes.size()); ++i) {
    if (Status s = check_node(complex, i); !s) return s;
    ends += complex.nodes[idx(i)].arcs.size();
  }
  if (ends != 2 * complex.arcs.size())
    return fail(ErrorCode::kInternal, fmt::format("complex: {} arc ends are listed", ends));
  std::vector<int> uses(complex.arcs.size(), 0);
  for (int i = 0; i < static_cast<int>(complex.cells.size()); ++i) {
    if (Status s = check_cell(complex, i); !s) return s;
    for (const int arc : complex.cells[idx(i)].arcs) ++uses[idx(arc)];
  }
  if (std::count(uses.begin(), uses.end(), 2) != static_cast<long>(uses.size()))
    return fail(ErrorCode::kInternal, "complex: an arc is not on two sides of cells");
  return {};
}

}  // namespace crosspatch
