#pragma once

#include <array>

#include "param/capped.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// A map of the given surfaces, made of a map of the capped ones.
struct JoinedMap {
  SurfaceMap map;
  /// Of the source and of the target: handles across whose cuts it does not go on (all or none) and
  /// holes whose rims it does not take to one of the other surface.
  std::array<int, 2> handles{0, 0}, holes{0, 0};
};

/// Makes a map of capped surfaces one of the given surfaces. Where both have as many handles and
/// the map takes the cuts of one near those of the other, the strips around them are mapped anew
/// such that the banks of cuts meet again; the same for as many holes, whose rims go to each other
/// by arc length. Cuts and holes that have no partner end the map: polygons on caps are left out.
/// Images of the source's vertices `kept` do not change.
JoinedMap join_openings(const SurfaceMap& closed,
                        const TriangleMesh& source,
                        const CappedSurface& capped_source,
                        const TriangleMesh& target,
                        const CappedSurface& capped_target,
                        const std::vector<int>& kept);

}  // namespace crosspatch
