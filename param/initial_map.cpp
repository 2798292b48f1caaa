#include "param/initial_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Lengths of shortest edge paths from `start`.
std::vector<double> edge_distances(const TriangleMesh& mesh, int start) {
  std::vector<double> distance(at(mesh.vertex_count()), std::numeric_limits<double>::infinity());
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
      queue;
  distance[at(start)] = 0;
  queue.emplace(0.0, start);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[at(v)]) continue;
    for_each_outgoing(mesh, v, [&, from = v, base = d](int h) {
      const int w = mesh.to(h);
      const double through = base + (mesh.position(from) - mesh.position(w)).norm();
      if (through < distance[at(w)]) {
        distance[at(w)] = through;
        queue.emplace(through, w);
      }
    });
  }
  return distance;
}

std::vector<int> level_vertices(const MeshLevel& level, const std::vector<int>& vertices) {
  std::vector<int> found;
  for (int v : vertices) {
    const auto it = std::lower_bound(level.vertex.begin(), level.vertex.end(), v);
    found.push_back(
        it != level.vertex.end() && *it == v ? static_cast<int>(it - level.vertex.begin()) : -1);
  }
  return found;
}

/// The shortest open chains through all points, given their distances (symmetric k x k), out of
/// every one for up to 7 points, else out of nearest-neighbour chains from some of them, improved
/// by reversals, and what one more reversal makes of these.
std::vector<std::vector<int>> shortest_chains(const Eigen::MatrixXd& D, int count) {
  const int k = static_cast<int>(D.rows());
  const auto length = [&](const std::vector<int>& c) {
    double sum = 0;
    for (size_t i = 0; i + 1 < c.size(); ++i) sum += D(c[i], c[i + 1]);
    return sum;
  };
  std::vector<std::pair<double, std::vector<int>>> chains;
  const auto add = [&](std::vector<int> c) {
    if (c.front() > c.back()) std::reverse(c.begin(), c.end());
    const double l = length(c);
    chains.emplace_back(l, std::move(c));
  };
  std::vector<int> chain(at(k));
  std::iota(chain.begin(), chain.end(), 0);
  constexpr int kAll = 7;
  if (k <= kAll) {
    do {
      if (chain.front() < chain.back()) chains.emplace_back(length(chain), chain);
    } while (std::next_permutation(chain.begin(), chain.end()));
  } else {
    constexpr int kStarts = 12;
    for (int start = 0; start < std::min(k, kStarts); ++start) {
      std::iota(chain.begin(), chain.end(), 0);
      std::swap(chain[0], chain[at(start)]);
      for (size_t i = 1; i < chain.size(); ++i)
        std::iter_swap(chain.begin() + static_cast<std::ptrdiff_t>(i),
                       std::min_element(
                           chain.begin() + static_cast<std::ptrdiff_t>(i),
                           chain.end(),
                           [&](int a, int b) { return D(chain[i - 1], a) < D(chain[i - 1], b); }));
      for (bool better = true; better;) {
        better = false;
        for (size_t i = 0; i < chain.size(); ++i)
          for (size_t j = i + 2; j <= chain.size(); ++j) {
            std::vector<int> trial = chain;
            std::reverse(trial.begin() + static_cast<std::ptrdiff_t>(i),
                         trial.begin() + static_cast<std::ptrdiff_t>(j));
            if (length(trial) < length(chain) - 1e-12) {
              chain = std::move(trial);
              better = true;
            }
          }
      }
      add(chain);
    }
    const auto shortest = chains;
    for (const auto& [unused, found] : shortest)
      for (size_t i = 0; i < found.size(); ++i)
        for (size_t j = i + 2; j <= found.size(); ++j) {
          std::vector<int> trial = found;
          std::reverse(trial.begin() + static_cast<std::ptrdiff_t>(i),
                       trial.begin() + static_cast<std::ptrdiff_t>(j));
          add(std::move(trial));
        }
  }
  std::sort(chains.begin(), chains.end());
  chains.erase(std::unique(chains.begin(), chains.end()), chains.end());
  std::vector<std::vector<int>> best;
  for (const auto& c : chains)
    if (static_cast<int>(best.size()) < count) best.push_back(c.second);
  return best;
}

}  // namespace

const std::vector<double>& ChainPlanner::distances(const Shape& shape,
                                                   std::map<int, std::vector<double>>& known,
                                                   int vertex) const {
  const auto [it, fresh] = known.try_emplace(vertex);
  if (fresh) it->second = edge_distances(shape.coarse.mesh, vertex);
  return it->second;
}

std::vector<std::pair<std::vector<int>, std::vector<int>>> ChainPlanner::chains(
    const std::vector<Landmark>& landmarks, int count) const {
  std::vector<int> a, b;
  for (const Landmark& l : landmarks) {
    a.push_back(l.source_vertex);
    b.push_back(l.target_vertex);
  }
  a = level_vertices(source_.coarse, a);
  b = level_vertices(target_.coarse, b);
  if (std::count(a.begin(), a.end(), -1) + std::count(b.begin(), b.end(), -1) > 0) return {};
  Eigen::MatrixXd D(landmarks.size(), landmarks.size());
  for (int i = 0; i < D.rows(); ++i) {
    const auto& da = distances(source_, source_distances_, a[at(i)]);
    const auto& db = distances(target_, target_distances_, b[at(i)]);
    for (int j = 0; j < D.cols(); ++j) D(i, j) = da[at(a[at(j)])] + db[at(b[at(j)])];
  }
  std::vector<std::pair<std::vector<int>, std::vector<int>>> chains;
  for (const std::vector<int>& order : shortest_chains(D, count)) {
    auto& [chain_a, chain_b] = chains.emplace_back();
    for (int i : order) {
      chain_a.push_back(a[at(i)]);
      chain_b.push_back(b[at(i)]);
    }
  }
  return chains;
}

std::vector<InitialMap> initial_maps(const Shape& source,
                                     const Shape& target,
                                     const std::vector<Landmark>& landmarks,
                                     int chains) {
  std::vector<InitialMap> maps;
  if (landmarks.size() < 2) return maps;
  for (const auto& [a, b] : ChainPlanner(source, target).chains(landmarks, chains)) {
    auto da = cut_along_chain(source.coarse.mesh, a);
    if (!da) continue;
    auto db = cut_along_chain(target.coarse.mesh, b);
    if (!db) continue;
    const double distortion = disc_distortion(*da, *db);
    maps.push_back({std::move(*da), std::move(*db), distortion});
  }
  std::stable_sort(maps.begin(), maps.end(), [](const InitialMap& a, const InitialMap& b) {
    return a.distortion < b.distortion;
  });
  return maps;
}

}  // namespace crosspatch
