#include "core/weld.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace crosspatch {
namespace {

using std::size_t;
using Cell = std::array<std::int64_t, 3>;

/// Follows `parent` to the root, halving the path; roots are the smallest index of their group.
int root(std::vector<int>& parent, int v) {
  while (parent[static_cast<size_t>(v)] != v) {
    int& up = parent[static_cast<size_t>(v)];
    up = parent[static_cast<size_t>(up)];
    v = up;
  }
  return v;
}

void join(std::vector<int>& parent, int a, int b) {
  a = root(parent, a);
  b = root(parent, b);
  parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
}

void join_identical(const MatrixX3d& V, const std::vector<int>& members, std::vector<int>& parent) {
  std::vector<int> order = members;
  const auto before = [&](int a, int b) {
    for (int k = 0; k < 3; ++k)
      if (V(a, k) != V(b, k)) return V(a, k) < V(b, k);
    return a < b;
  };
  std::sort(order.begin(), order.end(), before);
  for (size_t i = 1; i < order.size(); ++i)
    if (V.row(order[i]) == V.row(order[i - 1])) join(parent, order[i - 1], order[i]);
}

/// Compares only points whose cells, cubes of side `distance`, are neighbours.
void join_close(const MatrixX3d& V,
                const std::vector<int>& members,
                double distance,
                std::vector<int>& parent) {
  const Eigen::RowVector3d origin = V.colwise().minCoeff();
  std::vector<std::pair<Cell, int>> cells;
  cells.reserve(members.size());
  for (const int v : members) {
    Cell cell;
    for (int k = 0; k < 3; ++k)
      cell[static_cast<size_t>(k)] =
          static_cast<std::int64_t>(std::floor((V(v, k) - origin[k]) / distance));
    cells.emplace_back(cell, v);
  }
  std::sort(cells.begin(), cells.end());
  for (const auto& [cell, v] : cells)
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        // The three cells along z are consecutive in the sorted order.
        const Cell first{cell[0] + dx, cell[1] + dy, cell[2] - 1};
        const Cell last{cell[0] + dx, cell[1] + dy, cell[2] + 1};
        for (auto it = std::lower_bound(cells.begin(), cells.end(), std::pair(first, -1));
             it != cells.end() && it->first <= last;
             ++it)
          if (it->second > v && (V.row(v) - V.row(it->second)).norm() <= distance)
            join(parent, v, it->second);
      }
}

}  // namespace

std::vector<int> weld(const MatrixX3d& V, const std::vector<bool>& weldable, double distance) {
  std::vector<int> parent(static_cast<size_t>(V.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<int> members;
  for (size_t v = 0; v < weldable.size(); ++v)
    if (weldable[v]) members.push_back(static_cast<int>(v));
  join_identical(V, members, parent);
  if (distance > 0 && !members.empty()) join_close(V, members, distance, parent);
  for (int v = 0; v < V.rows(); ++v) parent[static_cast<size_t>(v)] = root(parent, v);
  return parent;
}

}  // namespace crosspatch
