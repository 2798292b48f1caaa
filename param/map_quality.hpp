#pragma once

#include "param/surface_map.hpp"

namespace crosspatch {

/// Figures of a surface map, both surfaces taken at area 1. Energies are |J|^2 + |J^-1|^2 of the
/// map on the pieces of the common subdivision (isometry: 4), weighted by the mean of their areas
/// on both surfaces.
struct MapQuality {
  int flipped = 0;  ///< pieces turned over on either surface beyond rounding
  double mean = 0;  ///< area-weighted mean energy
  double median = 0, percentile_90 = 0, percentile_99 = 0;
  double worst_stretch = 0;                         ///< largest singular value of J or J^-1
  double source_coverage = 0, target_coverage = 0;  ///< share of area that is mapped
};

/// Area-weighted mean of the energy over the pieces in the faces around each vertex, 4 where there
/// is none.
struct VertexDistortion {
  Eigen::VectorXd source, target;
};
VertexDistortion vertex_distortion(const SurfaceMap& map,
                                   const TriangleMesh& source,
                                   const TriangleMesh& target);

MapQuality measure_map(const SurfaceMap& map,
                       const TriangleMesh& source,
                       const TriangleMesh& target);

}  // namespace crosspatch
