#include "param/vertex_colours.hpp"

#include <algorithm>
#include <numeric>

#include "core/index.hpp"

namespace crosspatch {

std::vector<std::vector<int>> vertex_colours(const MatrixX3i& F, const std::vector<bool>& is_free) {
  std::vector<int> begin(is_free.size() + 1, 0), faces(idx(F.size()));
  for (const int v : F.reshaped()) ++begin[idx(v) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int> fill(begin.begin(), begin.end() - 1);
  for (int f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k) faces[idx(fill[idx(F(f, k))]++)] = f;
  std::vector<std::vector<int>> colours;
  std::vector<int> colour(is_free.size(), -1);
  std::vector<char> taken;
  for (std::size_t v = 0; v < is_free.size(); ++v) {
    if (!is_free[v] || begin[v] == begin[v + 1]) continue;
    taken.assign(colours.size() + 1, 0);
    for (int i = begin[v]; i < begin[v + 1]; ++i)
      for (int k = 0; k < 3; ++k)
        if (const int c = colour[idx(F(faces[idx(i)], k))]; c >= 0) taken[idx(c)] = 1;
    const auto free = std::find(taken.begin(), taken.end(), 0) - taken.begin();
    if (idx(free) == colours.size()) colours.emplace_back();
    colour[v] = static_cast<int>(free);
    colours[idx(free)].push_back(static_cast<int>(v));
  }
  return colours;
}

}  // namespace crosspatch
