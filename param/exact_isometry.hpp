#pragma once

#include "param/cell_relaxation.hpp"

namespace crosspatch {

/// Brings the vertices of two triangulations of one surface to where they belong: those of `coarse`
/// onto vertices of `fine`, then the other vertices of `fine` to their places inside the faces of
/// `coarse`. Succeeds only if that is a fact: every vertex of `coarse` meets one of `fine`, and
/// every edge of either mesh is as long between its ends' images on the other, up to a hundred
/// thousandth of the root of the area. Otherwise returns false and leaves both meshes unmoved.
/// Both are closed, of area 1 and positively oriented on the sphere, close to the isometry; pinned
/// vertices stay. At most `iterations` steps are made for either mesh.
bool make_exact_isometry(const MovingMesh& coarse, const MovingMesh& fine, int iterations);

}  // namespace crosspatch
