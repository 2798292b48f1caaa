#pragma once

#include <vector>

#include "core/surface_point.hpp"

namespace crosspatch {

/// For each vertex of the target a point of the source, or none.
struct PullBack {
  std::vector<SurfacePoint> points;  ///< #V target
  int torn_triangles =
      0;  ///< of the source: images of their corners lie far apart, or they stand alone
  int turned_triangles = 0;  ///< of the source: against most of the others
};

/// Goes back from the target's vertices over the triangles in space that the images of the source's
/// triangles span, see map_from_points. `images`: #V source. An image edge longer than `stretch`
/// times its edge plus `slack` is torn.
PullBack pull_back(const TriangleMesh& source,
                   const TriangleMesh& target,
                   const std::vector<SurfacePoint>& images,
                   double stretch,
                   double slack);

/// Mean length of the edges.
double mean_edge(const TriangleMesh& mesh);

}  // namespace crosspatch
