#pragma once

#include "core/matching.hpp"
#include "core/morse_smale.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

struct NodeMatchingOptions {
  /// Farthest that a node's image may lie from its partner, in sqrt(area), the mean over both
  /// directions.
  double reach = 0.15;
};

/// Matches the critical points of two surfaces that a map between them brings together: those of
/// one kind that lie nearest to each other's images, at least total distance over both directions.
/// Confidence is 1 at distance 0 and falls evenly to 0 at the reach. `map` speaks of the vertices
/// of `source` and `target`; nodes that it does not map stay alone.
Matching match_nodes(const TriangleMesh& source,
                     const TriangleMesh& target,
                     const MorseSmaleComplex& source_complex,
                     const MorseSmaleComplex& target_complex,
                     const SurfaceMap& map,
                     const NodeMatchingOptions& options = {});

}  // namespace crosspatch
