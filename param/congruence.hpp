#pragma once

#include "param/cell_relaxation.hpp"

namespace crosspatch {

/// Brings the vertices of two triangulations of one and the same surface, apart by a rotation, a
/// translation and a scale, to where they lie on each other in space, however needles and folds
/// hold them up on the sphere. Succeeds only if that is a fact: every vertex of either mesh ends on
/// the other's surface, up to a hundred thousandth of the root of the area. Otherwise returns false
/// and leaves both meshes unmoved. Both are closed, of area 1, positively oriented on the sphere
/// and close to the isometry; pinned vertices stay.
///
/// The similarity is found as in the iterative closest point method, from distances to tangent
/// planes (Chen & Medioni 1992), with images for closest points.
bool make_congruent(const MovingMesh& a, const MovingMesh& b);

}  // namespace crosspatch
