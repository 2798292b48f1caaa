#pragma once

#include <vector>

#include "param/capped.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// The target's cap that the map takes a cap of the source nearest to, per cap of the source: caps
/// of one handle go to those of one handle, holes to holes. Empty where the surfaces have different
/// numbers of handles, -1 for holes where those differ.
std::vector<int> match_caps(const SurfaceMap& closed,
                            const CappedSurface& source,
                            const CappedSurface& target);

/// Polygons of the map around each of the source's caps that has a partner: disjoint discs, each
/// holding the cap, all that goes to its partner and a strip about as wide as `width` times the
/// rim's length. Empty for caps without partner and for those where no such disc exists, because it
/// would meet another one or a vertex of `kept`.
std::vector<std::vector<int>> cap_regions(const SurfaceMap& closed,
                                          const CappedSurface& source,
                                          const CappedSurface& target,
                                          const std::vector<int>& partner,
                                          const std::vector<int>& kept,
                                          double width);

}  // namespace crosspatch
