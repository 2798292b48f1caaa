#include "param/congruence.hpp"

#include <gtest/gtest.h>

#include <random>

#include "param/lift.hpp"
#include "param/sphere_orientation.hpp"
#include "shapes.hpp"

namespace crosspatch {
namespace {

/// A surface without symmetries, and its refinement turned and moved in space, on one sphere, where
/// both have slipped far: by more than a fine edge.
struct TwoMeshes {
  TriangleMesh coarse, fine;
  MatrixX3d X, Y;
  const std::vector<int> none;

  TwoMeshes() {
    coarse = shapes::icosphere(2);
    X = coarse.V;
    for (int v = 0; v < coarse.vertex_count(); ++v) {
      const Vector3d x = X.row(v);
      coarse.V.row(v) = (1 + 0.2 * x[0] + 0.1 * x[1] * x[2]) *
                        Eigen::RowVector3d(1.2 * x[0], x[1], 0.8 * x[2] + 0.3 * x[0] * x[0]);
    }
    coarse = normalized(coarse);
    fine = shapes::refined(coarse);
    Y.resize(fine.vertex_count(), 3);
    Y.topRows(X.rows()) = X;
    for (int f = 0; f < coarse.face_count(); ++f)
      for (int k = 0; k < 3; ++k)
        Y.row(fine.F(4 * f + 3, k)) =
            (X.row(coarse.F(f, k)) + X.row(coarse.F(f, (k + 1) % 3))).normalized();
    const Eigen::AngleAxisd turn(1.1, Vector3d(0.3, -0.5, 0.8).normalized());
    fine.V =
        (fine.V * turn.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(3, -1, 0.5);
    for (MatrixX3d* places : {&X, &Y})
      for (int v = 0; v < places->rows(); ++v) {
        const Vector3d x = places->row(v);
        const double slip = places == &X ? 0.09 : -0.03;
        const Vector3d moved = x + slip * Vector3d(std::sin(4 * x[1]), x[2], -x[1]).cross(x);
        places->row(v) = moved.normalized().transpose();
      }
  }
};

TEST(Congruence, PutsEveryVertexOnTheOtherSurface) {
  TwoMeshes m;
  ASSERT_TRUE(make_congruent({m.coarse, m.none, m.X}, {m.fine, m.none, m.Y}));
  const MeshLift to_fine(m.fine, m.Y);
  int face = 0;
  for (int v = 0; v < m.coarse.vertex_count(); ++v)  // the refinement keeps the numbers
    EXPECT_LT((to_fine.point(m.X.row(v).transpose(), face) - m.fine.position(v)).norm(), 1e-5);
  for (const auto& [mesh, places] : {std::pair(&m.coarse, &m.X), std::pair(&m.fine, &m.Y)})
    for (int f = 0; f < mesh->face_count(); ++f)
      EXPECT_GT(sphere_orientation(places->row(mesh->F(f, 0)).transpose(),
                                   places->row(mesh->F(f, 1)).transpose(),
                                   places->row(mesh->F(f, 2)).transpose()),
                0);
}

TEST(Congruence, OfSurfacesThatDifferThereIsNone) {
  TwoMeshes m;
  const MatrixX3d X = m.X, Y = m.Y;
  m.fine.V.row(m.coarse.vertex_count() + 5) *= 1.01;  // the middle of a side
  EXPECT_FALSE(make_congruent({m.coarse, m.none, m.X}, {m.fine, m.none, m.Y}));
  EXPECT_EQ(m.X, X);
  EXPECT_EQ(m.Y, Y);
}

TEST(Congruence, PinnedVerticesStay) {
  TwoMeshes m;
  const std::vector<int> pinned{17};
  m.X.row(17) = m.Y.row(17);
  const Eigen::RowVector3d before = m.Y.row(17);
  ASSERT_TRUE(make_congruent({m.coarse, pinned, m.X}, {m.fine, pinned, m.Y}));
  EXPECT_EQ(m.X.row(17), before);
  EXPECT_EQ(m.Y.row(17), before);
}

}  // namespace
}  // namespace crosspatch
