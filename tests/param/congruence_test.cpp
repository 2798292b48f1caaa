#include "param/congruence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "param/lift.hpp"
#include "param/sphere_orientation.hpp"
#include "refined_pair.hpp"

namespace crosspatch {
namespace {

/// The refinement is turned and moved in space, and both have slipped far: by more than a fine
/// edge.
struct TwoMeshes : shapes::RefinedPair {
  const std::vector<int> none;

  TwoMeshes() {
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
