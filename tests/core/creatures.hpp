#pragma once

#include <array>

#include "shapes.hpp"

namespace crosspatch::shapes {

/// Directions of the limbs of creature(): four legs, a head and a tail of different lengths, no two
/// of them exchangeable.
inline std::array<Vector3d, 6> limb_directions() {
  return {Vector3d(1, 0.55, -1.0),
          Vector3d(1, -0.6, -1.05),
          Vector3d(-1, 0.5, -1.15),
          Vector3d(-1, -0.65, -0.95),
          Vector3d(1.7, 0.1, 0.9),
          Vector3d(-1.5, 0, 0.8)};
}

/// A star-shaped body with limbs: the icosphere of `levels` + 1 subdivisions pulled out along
/// `limbs`, each `stretch` times as long as the vector says.
inline TriangleMesh creature(int levels,
                             double stretch = 1,
                             const std::array<Vector3d, 6>& limbs = limb_directions()) {
  TriangleMesh mesh = icosphere(levels + 1);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vector3d direction = mesh.position(v);
    double radius = 1;
    for (const Vector3d& limb : limbs) {
      const double cosine = direction.dot(limb.normalized());
      radius += 1.2 * stretch * limb.norm() * std::exp(30 * (cosine - 1));
    }
    mesh.V.row(v) *= radius;
  }
  return mesh;
}

/// Limbs of clearly different lengths, so that point values alone tell them apart.
inline std::array<Vector3d, 6> uneven_limbs() {
  std::array<Vector3d, 6> limbs = limb_directions();
  for (size_t i = 0; i < limbs.size(); ++i) limbs[i] *= 0.6 + 0.25 * static_cast<double>(i);
  return limbs;
}

}  // namespace crosspatch::shapes
