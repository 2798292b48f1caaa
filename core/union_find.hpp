#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/index.hpp"

namespace crosspatch {

/// Disjoint sets of 0 .. count - 1; the least member stands for its set.
class UnionFind {
 public:
  explicit UnionFind(int count) : root_(idx(count)) { std::iota(root_.begin(), root_.end(), 0); }
  int find(int i) {
    while (root_[idx(i)] != i) i = root_[idx(i)] = root_[idx(root_[idx(i)])];
    return i;
  }
  /// Whether the two were apart.
  bool join(int i, int j) {
    const int a = find(i), b = find(j);
    root_[idx(std::max(a, b))] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<int> root_;
};

}  // namespace crosspatch
