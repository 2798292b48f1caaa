#include "core/manifold_cut.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/index.hpp"

namespace crosspatch {
namespace {

using std::size_t;

class Cutter {
 public:
  Cutter(const MatrixX3d& V, const MatrixX3i& T) : V_(V), T_(T) {
    const size_t triangles = idx(static_cast<int>(T.rows()));
    cut_.mate.assign(3 * triangles, -1);
    cut_.turned.assign(triangles, false);
    cut_.dropped.assign(triangles, false);
  }

  ManifoldCut run() {
    collect_edges();
    for (const auto& edge : edges_) pair_around(edge);
    orient();
    join_corners();
    while (part_false_edges()) join_corners();
    return std::move(cut_);
  }

 private:
  using Edge = std::vector<int>;  // the half-edges over one pair of vertices

  static int next(int h) { return h - h % 3 + (h + 1) % 3; }
  [[nodiscard]] int from(int h) const { return T_(h / 3, h % 3); }
  [[nodiscard]] int to(int h) const { return T_(h / 3, (h + 1) % 3); }
  [[nodiscard]] double area(int t) const {
    const Eigen::RowVector3d a = V_.row(T_(t, 0));
    return (V_.row(T_(t, 1)) - a).cross(V_.row(T_(t, 2)) - a).norm() / 2;
  }

  void glue(int h, int g) {
    cut_.mate[idx(h)] = g;
    cut_.mate[idx(g)] = h;
  }

  void unglue(int h) {
    const int g = std::exchange(cut_.mate[idx(h)], -1);
    if (g >= 0) cut_.mate[idx(g)] = -1;
  }

  void drop(int t) {
    cut_.dropped[idx(t)] = true;
    for (int k = 0; k < 3; ++k) unglue(3 * t + k);
  }

  /// Glues plain edges at once and keeps the crowded ones for pair_around.
  void collect_edges() {
    std::vector<std::pair<std::uint64_t, int>> sides(cut_.mate.size());
    for (int h = 0; h < static_cast<int>(sides.size()); ++h) {
      const auto [low, high] = std::minmax({from(h), to(h)});
      sides[idx(h)] = {static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high), h};
    }
    std::sort(sides.begin(), sides.end());
    for (size_t i = 0, j = 0; i < sides.size(); i = j) {
      while (j < sides.size() && sides[j].first == sides[i].first) ++j;
      if (j - i == 2) glue(sides[i].second, sides[i + 1].second);
      if (j - i <= 2) continue;
      Edge edge;
      for (size_t s = i; s < j; ++s) edge.push_back(sides[s].second);
      edges_.push_back(std::move(edge));
    }
    cut_.crowded_edges = static_cast<int>(edges_.size());
  }

  /// Unit vector in the triangle of h, perpendicular to its edge, towards the third vertex.
  [[nodiscard]] Vector3d inwards(int h) const {
    const Vector3d a = V_.row(from(h)), b = V_.row(to(h)), c = V_.row(T_(h / 3, (h + 2) % 3));
    const Vector3d along = (b - a).stableNormalized();
    return (c - a - along * along.dot(c - a)).stableNormalized();
  }

  /// Where as many sides run forwards as backwards, the file may mean solids that share an edge:
  /// sides pair across the narrowest wedge of material, behind both. Otherwise the flattest pair.
  void pair_around(const Edge& edge) {
    constexpr size_t kMostAroundAnEdge = 64;  // pairs grow with the square; such edges stay cut
    if (edge.size() > kMostAroundAnEdge) return;
    const auto forwards = [&](int h) { return from(h) < to(h); };
    const bool solids = 2 * std::count_if(edge.begin(), edge.end(), forwards) ==
                        static_cast<std::ptrdiff_t>(edge.size());
    const int first = edge.front();
    const Vector3d axis =
        (forwards(first) ? 1 : -1) * (V_.row(to(first)) - V_.row(from(first))).stableNormalized();
    const Vector3d zero = inwards(first), quarter = axis.cross(zero);
    std::vector<std::tuple<bool, double, int, int>> pairs;  // agreeing, then best first
    for (size_t i = 0; i < edge.size(); ++i)
      for (size_t j = i + 1; j < edge.size(); ++j) {
        // The front of a forward side is the way of growing angle about the axis.
        const int h = forwards(edge[i]) ? edge[i] : edge[j], g = edge[i] + edge[j] - h;
        const Vector3d a = inwards(h), b = inwards(g);
        double wedge =
            std::atan2(a.dot(quarter), a.dot(zero)) - std::atan2(b.dot(quarter), b.dot(zero));
        if (wedge < 0) wedge += 2 * std::numbers::pi;
        pairs.emplace_back(forwards(h) == forwards(g), solids ? wedge : a.dot(b), edge[i], edge[j]);
      }
    std::sort(pairs.begin(), pairs.end());
    for (const auto& [clash, cost, h, g] : pairs)
      if (cut_.mate[idx(h)] < 0 && cut_.mate[idx(g)] < 0) glue(h, g);
  }

  /// Floods each component from its first triangle; sides that cannot agree are unglued.
  void orient() {
    std::vector<bool> seen(cut_.turned.size(), false);
    std::vector<int> members;
    for (int seed = 0; seed < T_.rows(); ++seed) {
      if (seen[idx(seed)]) continue;
      seen[idx(seed)] = true;
      members.assign(1, seed);
      double turned_area = 0, kept_area = 0;
      for (size_t i = 0; i < members.size(); ++i) {
        const int t = members[i];
        (cut_.turned[idx(t)] ? turned_area : kept_area) += area(t);
        for (int h = 3 * t; h < 3 * t + 3; ++h) {
          const int g = cut_.mate[idx(h)];
          if (g < 0) continue;
          const bool turned = cut_.turned[idx(t)] != (from(h) == from(g));
          if (!seen[idx(g / 3)]) {
            seen[idx(g / 3)] = true;
            cut_.turned[idx(g / 3)] = turned;
            members.push_back(g / 3);
          } else if (cut_.turned[idx(g / 3)] != turned) {
            unglue(h);
            ++cut_.one_sided_edges;
          }
        }
      }
      if (turned_area > kept_area)
        for (const int t : members) cut_.turned[idx(t)] = !cut_.turned[idx(t)];
    }
  }

  int root(int corner) {
    while (cut_.vertex[idx(corner)] != corner) {
      int& up = cut_.vertex[idx(corner)];
      up = cut_.vertex[idx(up)];
      corner = up;
    }
    return corner;
  }

  void join(int a, int b) {
    a = root(a);
    b = root(b);
    cut_.vertex[idx(std::max(a, b))] = std::min(a, b);
  }

  /// Corners become one vertex where glued edges lead from one to the other.
  void join_corners() {
    cut_.vertex.resize(cut_.mate.size());
    std::iota(cut_.vertex.begin(), cut_.vertex.end(), 0);
    for (int h = 0; h < static_cast<int>(cut_.mate.size()); ++h) {
      const int g = cut_.mate[idx(h)];
      if (g < h) continue;
      join(h, from(g) == from(h) ? g : next(g));
      join(next(h), from(g) == from(h) ? next(g) : g);
    }
    for (int c = 0; c < static_cast<int>(cut_.vertex.size()); ++c) cut_.vertex[idx(c)] = root(c);
  }

  /// Half-edges over a crowded edge that have both vertices in common without being mates are
  /// unglued, and their triangles dropped when that has been done. True if anything changed.
  bool part_false_edges() {
    bool changed = false;
    for (const Edge& edge : edges_) {
      std::vector<std::tuple<int, int, int>> sides;
      for (const int h : edge) {
        if (cut_.dropped[idx(h / 3)]) continue;
        const auto [low, high] = std::minmax({cut_.vertex[idx(h)], cut_.vertex[idx(next(h))]});
        sides.emplace_back(low, high, h);
      }
      std::sort(sides.begin(), sides.end());
      for (size_t i = 1; i < sides.size(); ++i) {
        const auto [low, high, h] = sides[i];
        const auto [last_low, last_high, g] = sides[i - 1];
        if (low != last_low || high != last_high || cut_.mate[idx(h)] == g) continue;
        changed = true;
        if (cut_.mate[idx(h)] < 0 && cut_.mate[idx(g)] < 0) drop(h / 3);
        unglue(h);
        unglue(g);
      }
    }
    return changed;
  }

  const MatrixX3d& V_;
  const MatrixX3i& T_;
  std::vector<Edge> edges_;  // with more than two half-edges
  ManifoldCut cut_;
};

}  // namespace

ManifoldCut cut_to_manifold(const MatrixX3d& V, const MatrixX3i& T) {
  return Cutter(V, T).run();
}

std::vector<int> glued_components(const ManifoldCut& cut) {
  std::vector<int> component(cut.turned.size(), -1);
  std::vector<int> stack;
  int count = 0;
  for (int seed = 0; seed < static_cast<int>(component.size()); ++seed) {
    if (component[idx(seed)] >= 0 || cut.dropped[idx(seed)]) continue;
    component[idx(seed)] = count;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        const int g = cut.mate[idx(h)];
        if (g < 0 || component[idx(g / 3)] >= 0) continue;
        component[idx(g / 3)] = count;
        stack.push_back(g / 3);
      }
    }
    ++count;
  }
  return component;
}

}  // namespace crosspatch
