#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "param/judge.hpp"

namespace crosspatch {

/// The extremities (Shape::extremities) that a coarse map of two surfaces brings together, as
/// landmarks that are not pinned, by the source's order. `held` are the landmarks that the map was
/// made for; extremities near them are left out. Partners are at most 0.15 from each other's images
/// (sqrt(area), mean of both directions) and have least total cost: these distances, and how much
/// the distances on the surfaces to the landmarks and to the other extremities differ. Fingers
/// slip off each other on a coarse level, so that an image often lies between two; the other
/// distances tell which. Empty where no image lies farther than 0.01 from the partner: there
/// nothing has slipped.
std::vector<Landmark> slipped_extremities(const SphereMap& map,
                                          const Shape& source,
                                          const Shape& target,
                                          const std::vector<Landmark>& held);

/// A coarse map through more landmarks, on coarse levels that hold them.
struct GuidedMap {
  std::unique_ptr<std::pair<Shape, Shape>>
      shapes;  ///< of source and target; the map refers to them
  std::unique_ptr<SphereMap> map;
};

/// Makes the map again with the extremities that have slipped as further landmarks, as long as that
/// lowers what the finals judge by (judged_energy), by 0.03 or more, on the same coarse levels.
/// None where nothing has slipped or no such map is better. The options are those that
/// made the shapes and the winner.
std::optional<GuidedMap> guide_by_extremities(const Shape& source,
                                              const Shape& target,
                                              const Verdict::CoarseMap& winner,
                                              const ShapeOptions& shape_options,
                                              const MapOptions& map_options);

}  // namespace crosspatch
