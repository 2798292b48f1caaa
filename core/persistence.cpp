#include "core/persistence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>
#include <unordered_set>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// The extrema of one kind, merged as their saddles are cancelled; each set is named by its most
/// extreme member.
class ExtremaSets {
 public:
  /// `extremeness` (per vertex or face) is larger for an extremum that survives.
  ExtremaSets(std::vector<int> root, std::vector<int> extremeness)
      : root_(std::move(root)), extremeness_(std::move(extremeness)) {}

  int find(int cell) {
    int top = root_[idx(cell)];
    while (root_[idx(top)] != top) top = root_[idx(top)];
    while (root_[idx(cell)] != top) cell = std::exchange(root_[idx(cell)], top);
    return top;
  }

  /// Of the two sets of cells a and b the name of the less extreme, or -1 if they are one.
  int lesser(int a, int b) {
    const int x = find(a), y = find(b);
    if (x == y) return -1;
    return extremeness_[idx(x)] < extremeness_[idx(y)] ? x : y;
  }

  void merge(int a, int b) {
    const int gone = lesser(a, b);
    root_[idx(gone)] = gone == find(a) ? find(b) : find(a);
  }

 private:
  std::vector<int> root_, extremeness_;
};

std::vector<int> minus_ranks(const DiscreteGradient& gradient) {
  std::vector<int> result;
  for (const int r : gradient.rank) result.push_back(-r);
  return result;
}

std::vector<int> face_ranks(const DiscreteGradient& gradient) {
  std::vector<int> result;
  for (int f = 0; f < gradient.surface.face_count(); ++f)
    result.push_back(gradient.rank[idx(highest_corner(gradient, f))]);
  return result;
}

}  // namespace

Result<PersistenceHierarchy> persistence_hierarchy(const DiscreteGradient& gradient,
                                                   FieldScale scale) {
  Eigen::ArrayXd values = gradient.values.array();
  if (scale == FieldScale::kLog) {
    if (!(values.minCoeff() > 0))
      return fail(ErrorCode::kBadInput,
                  fmt::format("field: value {} has no logarithm", values.minCoeff()));
    values = values.log();
  }
  PersistenceHierarchy hierarchy{scale, values.maxCoeff() - values.minCoeff(), {}};
  const double unit = hierarchy.range > 0 ? hierarchy.range : 1;

  const TriangleMesh& mesh = gradient.surface;
  const GradientForests roots = forests(gradient);
  ExtremaSets minima(roots.minimum, minus_ranks(gradient));
  ExtremaSets maxima(roots.maximum, face_ranks(gradient));

  // The extremum that saddle h would take along, -1 if both its paths of that kind end at one.
  const auto partner = [&](int h, NodeKind kind) {
    return kind == NodeKind::kMinimum ? minima.lesser(mesh.from(h), mesh.to(h))
                                      : maxima.lesser(face_of(h), face_of(mesh.twin[idx(h)]));
  };
  const auto cost = [&](int h, NodeKind kind, int extremum) {
    const int v = kind == NodeKind::kMinimum ? extremum : highest_corner(gradient, extremum);
    return std::abs(values[highest_end(gradient, h)] - values[v]) / unit;
  };

  // (cost, rank of the saddle, kind, saddle): ties go to the lower saddle, then to minima.
  using Entry = std::tuple<double, int, NodeKind, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto push = [&](int h, NodeKind kind) {
    const int extremum = partner(h, kind);
    if (extremum < 0) return;
    queue.emplace(cost(h, kind, extremum), gradient.rank[idx(highest_end(gradient, h))], kind, h);
  };
  for (const int h : gradient.saddles) {
    push(h, NodeKind::kMinimum);
    push(h, NodeKind::kMaximum);
  }
  std::unordered_set<int> gone;
  while (!queue.empty()) {
    const auto [persistence, rank, kind, h] = queue.top();
    queue.pop();
    const int extremum = partner(h, kind);
    if (extremum < 0 || gone.contains(h)) continue;
    // Merging only makes partners more extreme, so costs only grow and the queue may be lazy.
    if (cost(h, kind, extremum) > persistence) {
      push(h, kind);
      continue;
    }
    if (kind == NodeKind::kMinimum) {
      minima.merge(mesh.from(h), mesh.to(h));
    } else {
      maxima.merge(face_of(h), face_of(mesh.twin[idx(h)]));
    }
    gone.insert(h);
    hierarchy.order.push_back({h, kind, extremum, persistence});
  }
  return hierarchy;
}

DiscreteGradient simplify(DiscreteGradient gradient,
                          const PersistenceHierarchy& hierarchy,
                          double threshold) {
  std::unordered_set<int> saddles, minima, maxima;
  for (const Cancellation& c : hierarchy.order) {
    if (!(c.persistence < threshold)) break;
    const bool is_minimum = c.kind == NodeKind::kMinimum;
    const EdgeRole role = is_minimum ? EdgeRole::kDescending : EdgeRole::kAscending;
    gradient.role[idx(c.saddle)] = role;
    gradient.role[idx(gradient.surface.twin[idx(c.saddle)])] = role;
    saddles.insert(c.saddle);
    (is_minimum ? minima : maxima).insert(c.extremum);
  }
  std::erase_if(gradient.saddles, [&](int h) { return saddles.contains(h); });
  std::erase_if(gradient.minima, [&](int v) { return minima.contains(v); });
  std::erase_if(gradient.maxima, [&](int f) { return maxima.contains(f); });
  return gradient;
}

}  // namespace crosspatch
