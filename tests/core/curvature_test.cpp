#include "core/curvature.hpp"

#include <gtest/gtest.h>

#include "core/creatures.hpp"
#include "shapes.hpp"

namespace crosspatch {
namespace {

TEST(Curvature, OfASphereIsConstantWhichSaysNothing) {
  const Eigen::MatrixXd fields = curvature_fields(shapes::icosphere(3)).value();
  EXPECT_EQ(fields.cols(), 4);
  EXPECT_EQ(fields.cwiseAbs().maxCoeff(), 0);
}

TEST(Curvature, IsLargestAtTheEndsOfAnEllipsoidAndSmallestAtItsWaist) {
  TriangleMesh mesh = shapes::icosphere(4);
  mesh.V.col(2) *= 3;
  const Eigen::MatrixXd fields = curvature_fields(mesh).value();
  Eigen::Index end = 0, waist = 0;
  mesh.V.col(2).maxCoeff(&end);
  mesh.V.col(2).cwiseAbs().minCoeff(&waist);
  for (int k = 0; k < fields.cols(); ++k) {
    EXPECT_GT(fields(end, k), 2) << k;
    EXPECT_LT(fields(waist, k), -0.5) << k;
  }
}

TEST(Curvature, DoesNotDependOnScaleAndRotationAndTurnsWithTheInside) {
  const TriangleMesh mesh = shapes::creature(3);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).matrix();
  TriangleMesh moved = mesh;
  moved.V = 7 * mesh.V * R.transpose();
  const Eigen::MatrixXd a = curvature_fields(mesh).value(), b = curvature_fields(moved).value();
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-6);  // mollification is relative to edges
  const TriangleMesh inside_out = make_mesh(mesh.V, mesh.F.rowwise().reverse()).value();
  const Eigen::MatrixXd c = curvature_fields(inside_out).value();
  for (int k = 0; k < 4; k += 2) {
    EXPECT_LT((a.col(k) + c.col(k)).cwiseAbs().maxCoeff(), 1e-6);          // mean: signed
    EXPECT_LT((a.col(k + 1) - c.col(k + 1)).cwiseAbs().maxCoeff(), 1e-6);  // Gaussian: not
  }
}

}  // namespace
}  // namespace crosspatch
