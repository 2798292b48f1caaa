#pragma once

#include "core/mesh.hpp"

namespace crosspatch {

/// A point of a triangle mesh: sum_k bary[k] * F(face, k). bary sums to 1 and is not negative
/// beyond rounding; face == -1 means "no point" (unmapped).
struct SurfacePoint {
  int face = -1;
  Vector3d bary = Vector3d::Zero();

  [[nodiscard]] bool valid() const { return face >= 0; }
};

inline Vector3d position(const TriangleMesh& mesh, const SurfacePoint& p) {
  return mesh.V.row(mesh.F(p.face, 0)).transpose() * p.bary[0] +
         mesh.V.row(mesh.F(p.face, 1)).transpose() * p.bary[1] +
         mesh.V.row(mesh.F(p.face, 2)).transpose() * p.bary[2];
}

/// Vertex v as a corner of its face out[v] / 3.
inline SurfacePoint point_at_vertex(const TriangleMesh& mesh, int v) {
  const int h = mesh.out[static_cast<std::size_t>(v)];
  SurfacePoint p{h / 3, Vector3d::Zero()};
  p.bary[h % 3] = 1;
  return p;
}

}  // namespace crosspatch
