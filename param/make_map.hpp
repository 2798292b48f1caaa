#pragma once

#include <string>
#include <vector>

#include "param/chain_disc.hpp"
#include "param/map_quality.hpp"
#include "param/shape.hpp"

namespace crosspatch {

/// A point of the source and the point of the target it must be mapped to.
struct Landmark {
  int source_vertex = -1;
  int target_vertex = -1;
};

struct MapOptions {
  int chains = 12;  ///< orders of the landmarks tried for the first cut; ours: 12 of 60 miss the
                    ///< best class in no trial pair
  int coarse_iterations = 60;  ///< most steps per stage of the optimisation on the coarse level
  int fine_iterations = 40;    ///< the same on the full mesh
};

/// A map found on the coarse levels, before any optimisation.
struct InitialMap {
  ChainDisc source_disc, target_disc;
  double distortion = 0;  ///< disc_distortion of the two
};

/// Cuts both coarse levels along chains through the landmarks (in the orders of least total length)
/// and keeps the pair of discs with the least distortion. Landmarks are vertices of the full
/// meshes, at least two. kNoCorrespondence if no chain can be cut.
Result<InitialMap> initial_map(const Shape& source,
                               const Shape& target,
                               const std::vector<Landmark>& landmarks,
                               int chains);

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
