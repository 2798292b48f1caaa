#include "core/order_correction.hpp"

#include <algorithm>
#include <optional>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Neighbours of node n in the complex, each once, counter-clockwise by its first arc.
std::vector<int> neighbours(const FeatureGraph& graph, int n) {
  std::vector<int> around;
  for (const int a : graph.node(n).arcs) {
    const FeatureArc& arc = graph.arcs[idx(a)];
    const int other = arc.saddle == n ? arc.extremum : arc.saddle;
    if (std::find(around.begin(), around.end(), other) == around.end()) around.push_back(other);
  }
  return around;
}

/// The paper's N^1 and N^2 of a matched node: neighbours whose partners are neighbours of its
/// partner, each list in its own surface's cyclic order.
struct Neighbourhood {
  std::vector<int> source, target;
};

Neighbourhood matched_neighbours(const FeatureGraph& source,
                                 const FeatureGraph& target,
                                 const std::vector<int>& partner,
                                 int n) {
  const std::vector<int> around = neighbours(target, partner[idx(n)]);
  Neighbourhood result;
  for (const int m : neighbours(source, n))
    if (std::find(around.begin(), around.end(), partner[idx(m)]) != around.end())
      result.source.push_back(m);
  for (const int t : around)
    if (std::any_of(result.source.begin(), result.source.end(), [&](int m) {
          return partner[idx(m)] == t;
        }))
      result.target.push_back(t);
  return result;
}

bool in_order(const Neighbourhood& n, const std::vector<int>& partner) {
  if (n.source.size() <= 2) return true;
  const auto start = std::find(n.target.begin(), n.target.end(), partner[idx(n.source[0])]);
  const size_t offset = idx(start - n.target.begin());
  for (size_t i = 0; i < n.source.size(); ++i)
    if (partner[idx(n.source[i])] != n.target[(offset + i) % n.target.size()]) return false;
  return true;
}

/// The turn of n.target against n.source that keeps kinds and most partners; among equals that of
/// the largest total score.
std::optional<size_t> best_turn(const FeatureGraph& source,
                                const FeatureGraph& target,
                                const Eigen::MatrixXd& score,
                                const std::vector<int>& partner,
                                const Neighbourhood& n) {
  std::optional<size_t> best;
  std::pair<int, double> best_key;
  for (size_t turn = 0; turn < n.source.size(); ++turn) {
    std::pair<int, double> key{0, 0};
    bool same_kinds = true;
    for (size_t i = 0; i < n.source.size(); ++i) {
      const int s = n.source[i], t = n.target[(turn + i) % n.target.size()];
      same_kinds &= source.node(s).kind == target.node(t).kind;
      key.first += partner[idx(s)] == t ? 1 : 0;
      key.second += score(s, t);
    }
    if (!same_kinds || (best && key <= best_key)) continue;
    best = turn;
    best_key = key;
  }
  return best;
}

}  // namespace

std::vector<int> wrongly_ordered(const FeatureGraph& source,
                                 const FeatureGraph& target,
                                 const std::vector<int>& partner) {
  std::vector<int> wrong;
  for (int n = 0; n < source.node_count(); ++n)
    if (partner[idx(n)] >= 0 && !in_order(matched_neighbours(source, target, partner, n), partner))
      wrong.push_back(n);
  return wrong;
}

int correct_order(const FeatureGraph& source,
                  const FeatureGraph& target,
                  const Eigen::MatrixXd& score,
                  std::vector<int>& partner) {
  std::vector<bool> visited(partner.size(), false);
  int corrected = 0;
  while (true) {
    // The queue of the paper, taken anew: a correction may make others wrong or right.
    int next = -1;
    for (const int n : wrongly_ordered(source, target, partner))
      if (!visited[idx(n)] &&
          (next < 0 || score(n, partner[idx(n)]) > score(next, partner[idx(next)])))
        next = n;
    if (next < 0) return corrected;
    visited[idx(next)] = true;
    const Neighbourhood around = matched_neighbours(source, target, partner, next);
    const auto turn = best_turn(source, target, score, partner, around);
    if (!turn) continue;
    for (size_t i = 0; i < around.source.size(); ++i)
      partner[idx(around.source[i])] = around.target[(*turn + i) % around.target.size()];
    ++corrected;
  }
}

}  // namespace crosspatch
