#include "param/extremities.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assignment.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// The extremities of a surface that are not near landmarks, with their distances (sqrt(area)).
struct Side {
  std::vector<int> vertex;
  std::vector<Eigen::Index> column;  ///< of Shape::extremity_distances
  const Shape* shape;

  [[nodiscard]] double distance(size_t i, int to_vertex) const {
    return shape->extremity_distances(to_vertex, column[i]);
  }
  [[nodiscard]] double distance(size_t i, const PlaceOnMesh& p) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += p.bary[k] * distance(i, p.vertex[static_cast<size_t>(k)]);
    return sum;
  }
};

Side free_extremities(const Shape& shape,
                      const std::vector<Landmark>& held,
                      int Landmark::*vertex) {
  constexpr double kNear = 0.03;  // fingertips of one hand are farther apart along the surface
  Side side{{}, {}, &shape};
  for (size_t i = 0; i < shape.extremities.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const bool guided = std::any_of(held.begin(), held.end(), [&](const Landmark& l) {
      return shape.extremity_distances(l.*vertex, column) < kNear;
    });
    if (guided) continue;
    side.vertex.push_back(shape.extremities[i]);
    side.column.push_back(column);
  }
  return side;
}

/// Distances between extremities and each other's images, the mean over both directions.
Eigen::MatrixXd slips(const SphereMap& map, const Side& a, const Side& b) {
  const std::vector<PlaceOnMesh> images = map.coarse_images(a.vertex),
                                 preimages = map.coarse_preimages(b.vertex);
  Eigen::MatrixXd slip(a.vertex.size(), b.vertex.size());
  for (size_t i = 0; i < a.vertex.size(); ++i)
    for (size_t j = 0; j < b.vertex.size(); ++j)
      slip(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          (b.distance(j, images[i]) + a.distance(i, preimages[j])) / 2;
  return slip;
}

/// How much the distances from each extremity to the landmarks differ, on average; near ones count
/// most (by the inverse square of the distance), for they tell fingers of one hand apart.
Eigen::MatrixXd disagreement(const Side& a, const Side& b, const std::vector<Landmark>& landmarks) {
  constexpr double kLeast = 1e-3;  // so that a landmark close by does not decide alone
  Eigen::MatrixXd mean(a.vertex.size(), b.vertex.size());
  for (size_t i = 0; i < a.vertex.size(); ++i)
    for (size_t j = 0; j < b.vertex.size(); ++j) {
      double sum = 0, weights = 0;
      for (const Landmark& l : landmarks) {
        if (l.source_vertex == a.vertex[i] || l.target_vertex == b.vertex[j]) continue;
        const double here = a.distance(i, l.source_vertex), there = b.distance(j, l.target_vertex);
        const double weight = 1 / std::max(kLeast, (here + there) * (here + there));
        sum += weight * std::abs(here - there);
        weights += weight;
      }
      mean(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          weights > 0 ? sum / weights : 0;
    }
  return mean;
}

/// A coarse map through the landmarks, optimised, and what it is judged by.
struct Trial {
  std::unique_ptr<SphereMap> map;
  double energy = std::numeric_limits<double>::infinity();
};

/// The best of the first so many initial maps that can be started.
Trial try_landmarks(const std::pair<Shape, Shape>& shapes,
                    const std::vector<Landmark>& landmarks,
                    size_t starts,
                    const MapOptions& options) {
  // Fingers lie so close that the map of least distortion is not always one that can be unfolded,
  // and that maps along other chains may run around other fingers.
  constexpr int kChains = 16;
  const auto judged = [](const Trial& trial, double energy) {
    return std::log(energy) + trial.map->coarse_distortion();
  };
  std::vector<Trial> trials;
  for (const InitialMap& initial : initial_maps(shapes.first, shapes.second, landmarks, kChains)) {
    Trial trial{std::make_unique<SphereMap>(shapes.first, shapes.second, landmarks, options)};
    if (!trial.map->start(initial)) continue;
    trial.energy = judged(trial, trial.map->optimize_roughly());
    trials.push_back(std::move(trial));
    if (trials.size() == starts) break;
  }
  if (trials.empty()) return {};
  Trial& best = *std::min_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
    return a.energy < b.energy;
  });
  best.energy = judged(best, best.map->optimize_coarse());
  return std::move(best);
}

/// Both surfaces with coarse levels that hold the landmarks; null where one cannot be coarsened.
std::unique_ptr<std::pair<Shape, Shape>> holding(const Shape& source,
                                                 const Shape& target,
                                                 const std::vector<Landmark>& landmarks,
                                                 const ShapeOptions& options) {
  std::vector<int> on_source, on_target;
  for (const Landmark& l : landmarks) {
    on_source.push_back(l.source_vertex);
    on_target.push_back(l.target_vertex);
  }
  Result<Shape> a = fail(ErrorCode::kInternal, "not run"), b = a;
  tbb::parallel_invoke([&] { a = with_coarse_level(source, on_source, options); },
                       [&] { b = with_coarse_level(target, on_target, options); });
  if (!a || !b) return nullptr;
  return std::make_unique<std::pair<Shape, Shape>>(std::move(*a), std::move(*b));
}

}  // namespace

std::vector<Landmark> slipped_extremities(const SphereMap& map,
                                          const Shape& source,
                                          const Shape& target,
                                          const std::vector<Landmark>& held) {
  // On the FAUST scans looked at fingers had slipped by 0.02 to 0.11; what is in place is within
  // half an edge.
  constexpr double kReach = 0.15, kSlipped = 0.01, kNever = 1e3;
  constexpr double kLocal = 3;  // with 1 one pair of fingers of three FAUST pairs was exchanged
  constexpr int kRounds = 4;    // those found in one are anchors of the next
  const Side a = free_extremities(source, held, &Landmark::source_vertex),
             b = free_extremities(target, held, &Landmark::target_vertex);
  if (a.vertex.empty() || b.vertex.empty()) return {};
  const Eigen::MatrixXd slip = slips(map, a, b);
  std::vector<Landmark> found;
  double most = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Landmark> anchors = held;
    anchors.insert(anchors.end(), found.begin(), found.end());
    const Eigen::MatrixXd cost =
        (slip.array() < kReach).select(slip + kLocal * disagreement(a, b, anchors), kNever);
    const std::vector<int> partner = least_cost_assignment(cost);
    found.clear();
    most = 0;
    for (size_t i = 0; i < partner.size(); ++i) {
      if (partner[i] < 0 || slip(static_cast<Eigen::Index>(i), partner[i]) >= kReach) continue;
      most = std::max(most, slip(static_cast<Eigen::Index>(i), partner[i]));
      found.push_back({a.vertex[i], b.vertex[static_cast<size_t>(partner[i])], false});
    }
  }
  return most > kSlipped ? found : std::vector<Landmark>{};
}

std::optional<GuidedMap> guide_by_extremities(const Shape& source,
                                              const Shape& target,
                                              const Verdict::CoarseMap& winner,
                                              const ShapeOptions& shape_options,
                                              const MapOptions& map_options) {
  constexpr int kRounds = 3;
  // Fingers of FAUST scans gain 0.03 to 0.11. Less may be chance: a pair of animals that gained
  // 0.025 had a mean error of 0.067, from 0.057.
  constexpr double kWorthwhile = 0.03;
  constexpr size_t kStarts = 3;
  std::optional<GuidedMap> best;
  std::vector<Landmark> held = winner.landmarks;
  for (int round = 0; round < kRounds; ++round) {
    const SphereMap& now = best ? *best->map : *winner.map;
    const Shape &a = best ? best->shapes->first : source, &b = best ? best->shapes->second : target;
    const std::vector<Landmark> slipped = slipped_extremities(now, a, b, held);
    if (slipped.empty()) break;
    std::vector<Landmark> all = held;
    all.insert(all.end(), slipped.begin(), slipped.end());
    auto shapes = holding(a, b, all, shape_options);
    if (shapes == nullptr) break;
    Trial with, without;
    tbb::parallel_invoke([&] { with = try_landmarks(*shapes, all, kStarts, map_options); },
                         [&] { without = try_landmarks(*shapes, held, 1, map_options); });
    if (!(with.energy < without.energy - kWorthwhile)) break;
    best = GuidedMap{std::move(shapes), std::move(with.map)};
    held = std::move(all);
  }
  return best;
}

}  // namespace crosspatch
