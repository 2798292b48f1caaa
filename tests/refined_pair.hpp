#pragma once

#include "shapes.hpp"

namespace crosspatch::shapes {

/// A surface without symmetries, of area 1, and its 1:4 refinement, both in their places on one
/// sphere (unit rows). The refinement keeps the numbers of the vertices.
struct RefinedPair {
  TriangleMesh coarse, fine;
  MatrixX3d X, Y;

  RefinedPair() : coarse(icosphere(2)), X(coarse.V) {
    for (int v = 0; v < coarse.vertex_count(); ++v) {
      const Vector3d x = X.row(v);
      coarse.V.row(v) = (1 + 0.2 * x[0] + 0.1 * x[1] * x[2]) *
                        Eigen::RowVector3d(1.2 * x[0], x[1], 0.8 * x[2] + 0.3 * x[0] * x[0]);
    }
    coarse = normalized(coarse);
    fine = refined(coarse);
    Y.resize(fine.vertex_count(), 3);
    Y.topRows(X.rows()) = X;
    for (int f = 0; f < coarse.face_count(); ++f)
      for (int k = 0; k < 3; ++k)
        Y.row(fine.F(4 * f + 3, k)) =
            (X.row(coarse.F(f, k)) + X.row(coarse.F(f, (k + 1) % 3))).normalized();
  }
};

}  // namespace crosspatch::shapes
