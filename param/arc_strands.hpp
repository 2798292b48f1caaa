#pragma once

#include <vector>

#include "param/layout.hpp"

namespace crosspatch {

/// A place that an arc passes on its way over a triangle mesh.
struct StrandStop {
  enum class Kind { kVertex, kEdge, kFace };
  Kind kind = Kind::kVertex;
  int cell = -1;  ///< vertex, lower half-edge of the edge, or face
  /// Order of the stops on one edge, from its lower half-edge's start: zone (0 beside the start, 1
  /// in the middle, 2 beside the end), then rank within the zone.
  int zone = 1;
  int rank = 0;
};

/// The arcs of `layout`, made of `gradient`, as sequences of stops, from saddle to extremum. Drawn
/// straight from stop to stop, with the stops of each edge in their order, no two arcs meet except
/// in nodes. Consecutive stops lie in one face and, but for stretches along an edge, not on one
/// edge.
std::vector<std::vector<StrandStop>> arc_strands(const QuadLayout& layout,
                                                 const DiscreteGradient& gradient);

}  // namespace crosspatch
