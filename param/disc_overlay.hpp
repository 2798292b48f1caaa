#pragma once

#include <vector>

#include "param/surface_map.hpp"

namespace crosspatch {

/// A disc cut out of a surface and laid out in the plane.
struct FlatDisc {
  const TriangleMesh& mesh;
  const MatrixX2d& uv;           ///< #V x 2, every triangle counter-clockwise
  const std::vector<int>& loop;  ///< the boundary, surface on the left
};

/// The map between two discs that are laid over each other. Their loops have the same length and
/// bit-equal places entry by entry; the region is convex. Inner vertices in special position are
/// moved by at most a millionth of their edges. kNumerical if that does not help.
Result<SurfaceMap> overlay_discs(const FlatDisc& a, const FlatDisc& b);

/// A point of a mesh whose faces are pieces of faces of `parent`, as a point of `parent`.
/// `origin`: per vertex of the piece where it lies; `parent_face`: per face of the piece.
SurfacePoint on_parent(const TriangleMesh& piece,
                       const std::vector<SurfacePoint>& origin,
                       const std::vector<int>& parent_face,
                       const TriangleMesh& parent,
                       const SurfacePoint& p);

}  // namespace crosspatch
