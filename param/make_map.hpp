#pragma once

#include <string>
#include <vector>

#include "param/initial_map.hpp"
#include "param/map_quality.hpp"

namespace crosspatch {

struct MapOptions {
  int coarse_iterations = 60;  ///< most steps per stage of the optimisation on the coarse level
  int fine_iterations = 40;    ///< the same on the full mesh
  /// Weight of the agreement of curvatures: see SphereProblem::field_weight.
  double field_weight = 0.6;
};

struct MapResult {
  SurfaceMap map;  ///< of shape.mesh to shape.mesh
  MapQuality quality;
  double initial_distortion = 0;
};

/// The bijective map that takes every landmark exactly to its partner and has (locally) least
/// symmetric Dirichlet energy. The homotopy class is that of `initial`.
Result<MapResult> optimize_map(const Shape& source,
                               const Shape& target,
                               const InitialMap& initial,
                               const std::vector<Landmark>& landmarks,
                               const MapOptions& options = {});

}  // namespace crosspatch
