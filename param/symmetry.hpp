#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/candidates.hpp"
#include "param/judge.hpp"

namespace crosspatch {

/// What exchanges left and right on a surface: its best map onto itself that turns orientation
/// around.
struct Reflection {
  std::vector<int> partner;  ///< per vertex: the vertex nearest to its image
  double margin = 0;         ///< Verdict::margin; maps that are not their own inverses are punished
};

/// The same surface seen in a mirror: vertices keep their numbers, faces face outwards.
Shape mirror_image(const Shape& shape);

/// Looks for it among the assignments of the tips to each other that are their own inverses; the
/// coarse level must hold the tips. Empty if none of them has a map.
std::optional<Reflection> find_reflection(const Shape& shape,
                                          const ShapeFeatures& features,
                                          const MapOptions& options);

/// Per tip the one that its image lies near, -1 where they do not exchange each other.
std::vector<int> exchanged_tips(const Reflection& reflection, const ShapeFeatures& features);

/// The reflections of two surfaces. A map between bodies should take the one to the other: legs
/// come in pairs and go to pairs, a tail does not go to a leg.
struct Reflections {
  Reflection source, target;

  /// How far they are to be believed, in [0, 1]: not where another reflection is all but as good.
  [[nodiscard]] double trust() const;
};

/// Empty if either has none. Runs on both surfaces at once.
std::optional<Reflections> find_reflections(const std::pair<Shape, Shape>& shapes,
                                            const std::pair<ShapeFeatures, ShapeFeatures>& features,
                                            const MapOptions& options);

/// How far a coarse map is from taking one reflection to the other: mean distance on the target,
/// through space and in sqrt(area), between where the source's coarse vertices come by the
/// reflection and then the map and where they come by the map and then the reflection.
double asymmetry(const SphereMap& map,
                 const Shape& source,
                 const Shape& target,
                 const Reflections& reflections);

/// What a map is judged worse by for its asymmetry, in units of Candidate::energy.
double symmetry_penalty(const SphereMap& map,
                        const Shape& source,
                        const Shape& target,
                        const Reflections& reflections);

}  // namespace crosspatch
