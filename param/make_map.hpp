#pragma once

#include "param/map_quality.hpp"
#include "param/sphere_map.hpp"

namespace crosspatch {

struct MapResult {
  SurfaceMap map;  ///< of shape.mesh to shape.mesh
  MapQuality quality;
};

/// Brings a map whose coarse level is optimised to the full meshes: the bijective map that takes
/// every pinned landmark exactly to its partner and has (locally) least energy.
Result<MapResult> finish_map(SphereMap& coarse, const Shape& source, const Shape& target);

/// All stages, for one initial map. The homotopy class is that of `initial`.
Result<MapResult> optimize_map(const Shape& source,
                               const Shape& target,
                               const InitialMap& initial,
                               const std::vector<Landmark>& landmarks,
                               const MapOptions& options = {});

}  // namespace crosspatch
