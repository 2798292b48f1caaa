#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// A point on the boundary of a triangle that is to be cut into smaller ones.
struct FacePoint {
  int vertex = -1;
  Vector3d bary = Vector3d::Zero();  ///< a coordinate is exactly zero on the opposite side
};

/// A vertex inside the triangle, joined to some boundary points.
struct FaceCentre {
  int vertex = -1;
  std::vector<int> spokes;   ///< indices into the boundary points
  std::vector<int> outside;  ///< boundary points that chords must part from the vertex
};

struct FaceSubdivision {
  std::vector<std::array<int, 3>> triangles;  ///< vertices, counter-clockwise
  Vector3d centre = Vector3d::Zero();  ///< where the inner vertex was placed, if there is one
};

/// Cuts the triangle with `corners` (positions, one a row) along chords between points of its
/// boundary, given counter-clockwise and including the corners. Chords do not cross, and none joins
/// points of one side. Among the triangulations those with wide angles are preferred; no triangle
/// has its corners on one side. Empty if the chords contradict this.
FaceSubdivision subdivide_face(const Eigen::Matrix3d& corners,
                               const std::vector<FacePoint>& boundary,
                               const std::vector<std::array<int, 2>>& chords,
                               const std::optional<FaceCentre>& centre);

}  // namespace crosspatch
