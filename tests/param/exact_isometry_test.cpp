#include "param/exact_isometry.hpp"

#include <gtest/gtest.h>

#include <random>

#include "param/lift.hpp"
#include "refined_pair.hpp"

namespace crosspatch {
namespace {

constexpr int kIterations = 40;

/// Both have slipped a little.
struct TwoMeshes : shapes::RefinedPair {
  TwoMeshes() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> noise(-0.01, 0.01);  // edges are 0.14 and more
    for (MatrixX3d* places : {&X, &Y}) {
      for (int v = 0; v < places->rows(); ++v)
        places->row(v) += Eigen::RowVector3d(noise(random), noise(random), noise(random));
      places->rowwise().normalize();
    }
  }
};

TEST(ExactIsometry, PutsEveryVertexWhereItBelongs) {
  TwoMeshes m;
  const std::vector<int> none;
  ASSERT_TRUE(make_exact_isometry({m.coarse, none, m.X}, {m.fine, none, m.Y}, kIterations));
  EXPECT_EQ(m.X, m.Y.topRows(m.X.rows()));
  const MeshLift to_coarse(m.coarse, m.X);
  int face = 0;
  for (int v = 0; v < m.fine.vertex_count(); ++v)
    EXPECT_LT((to_coarse.point(m.Y.row(v).transpose(), face) - m.fine.position(v)).norm(), 1e-5);
}

TEST(ExactIsometry, PinnedVerticesStay) {
  TwoMeshes m;
  const std::vector<int> pinned{17};  // of either mesh: the refinement keeps the numbers
  m.X.row(17) = m.Y.row(17);
  const Eigen::RowVector3d before = m.Y.row(17);
  ASSERT_TRUE(make_exact_isometry({m.coarse, pinned, m.X}, {m.fine, pinned, m.Y}, kIterations));
  EXPECT_EQ(m.X.row(17), before);
  EXPECT_EQ(m.Y.row(17), before);
}

TEST(ExactIsometry, OfSurfacesThatDifferThereIsNone) {
  TwoMeshes m;
  const std::vector<int> none;
  const MatrixX3d X = m.X, Y = m.Y;
  m.fine.V.row(m.coarse.vertex_count() + 5) *= 1.01;  // the middle of a side
  EXPECT_FALSE(make_exact_isometry({m.coarse, none, m.X}, {m.fine, none, m.Y}, kIterations));
  m.fine = shapes::refined(m.coarse);
  m.fine.V.row(5) *= 1.01;  // a corner
  EXPECT_FALSE(make_exact_isometry({m.coarse, none, m.X}, {m.fine, none, m.Y}, kIterations));
  EXPECT_EQ(m.X, X);
  EXPECT_EQ(m.Y, Y);
}

TEST(ExactIsometry, NeedsAVertexAtEveryVertex) {
  TwoMeshes m;
  const std::vector<int> none;
  const MatrixX3d X = m.X, Y = m.Y;
  EXPECT_FALSE(make_exact_isometry({m.fine, none, m.Y}, {m.coarse, none, m.X}, kIterations));
  EXPECT_EQ(m.X, X);
  EXPECT_EQ(m.Y, Y);
}

}  // namespace
}  // namespace crosspatch
