#pragma once

#include <utility>
#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// Where a vertex on the unit sphere may lie without turning a face around it over: the kernel of
/// its ring, in the gnomonic plane about `center`, where great circles are lines. Vectors of a
/// kernel are its corners in counter-clockwise order.
class RingKernel {
 public:
  /// `ring`: opposite edges of the faces, each with the vertex on its left. A ring vertex that
  /// lies at the centre itself is numbered `at_center`.
  RingKernel(const MatrixX3d& X,
             const std::vector<std::pair<int, int>>& ring,
             const Vector3d& center,
             int at_center = -1);

  /// Nothing where doubles see no room.
  [[nodiscard]] const std::vector<Vector2d>& corners() const { return corners_; }
  [[nodiscard]] Vector2d centroid() const;
  /// The unit vector at p of the plane.
  [[nodiscard]] Vector3d on_sphere(const Vector2d& p) const {
    return (center_ + p[0] * e1_ + p[1] * e2_).normalized();
  }

 private:
  Vector3d center_, e1_, e2_;
  std::vector<Vector2d> corners_;
};

}  // namespace crosspatch
