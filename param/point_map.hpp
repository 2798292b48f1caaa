#pragma once

#include <vector>

#include "param/surface_map.hpp"

namespace crosspatch {

struct PointMapOptions {
  /// An edge is torn when its image is longer than this many times the edge, both surfaces taken at
  /// the same area, and ...
  double stretch = 6;
  /// ... than this many mean edges of the other surface more: nearest vertices are that coarse.
  double slack = 2;
};

/// What became of a map that was given by points.
struct PointMapStatistics {
  int source_triangles = 0, target_triangles = 0;
  int unmapped_source_vertices = 0;   ///< without an image
  int torn_source_triangles = 0;      ///< images of their corners lie far apart
  int turned_source_triangles = 0;    ///< against most of the others
  int target_vertices_without = 0;    ///< no image of a source triangle is near
  int torn_target_triangles = 0;      ///< their corners come from places far apart
  int unmapped_target_triangles = 0;  ///< those, and others that could not be filled
  double source_coverage = 0;         ///< share of the source's area that is used, once or more
};

struct PointMap {
  SurfaceMap map;
  PointMapStatistics statistics;
};

/// Makes the best of a map given by the images of the source's vertices (#V; no point where
/// unmapped), which need not be one-to-one nor continuous.
///
/// The images of the corners of each source triangle span a triangle in space; torn ones are left
/// out. Each target vertex goes back to the nearest of these that lies on the same side of the
/// surface and within reach (half its longest edge, or a mean edge of the target), those that are
/// turned over against the majority less gladly by half an edge. Between its corners a target
/// triangle goes back to the source along great circles of the source's embedding in the sphere,
/// with weights that make up for its changes of scale, so that it is cut exactly along the edges of
/// the source. Target triangles whose sides go too far on the source are torn and stay unmapped, as
/// do those that reach over holes of the source or its cut handles.
///
/// The result covers each target triangle once or not at all. Where the given map folds, places of
/// the source are used several times and pieces may run clockwise on it; validate tells. Errors of
/// the embedding: kNoCorrespondence, kNumerical.
Result<PointMap> map_from_points(const TriangleMesh& source,
                                 const TriangleMesh& target,
                                 const std::vector<SurfacePoint>& images,
                                 const PointMapOptions& options = {});

}  // namespace crosspatch
