#include "param/lift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapes.hpp"

namespace crosspatch {
namespace {

TEST(MeshLift, WalksStraightAheadByTheLengthOfTheVector) {
  const TriangleMesh mesh = shapes::icosphere(4);
  const MeshLift lift(mesh, mesh.V);
  const Vector3d start = Vector3d(0.3, -0.5, 0.8).normalized();
  int face = 0;
  const Vector3d p = lift.point(start, face);
  const Lift::Frame frame = lift.frame(start, face);
  for (const double length : {0.05, 0.7, 2.0}) {
    int end = face;
    const Vector3d x = lift.walk(start, end, length * frame.on_surface.col(0));
    const double angle = std::atan2(start.cross(x).norm(), start.dot(x));
    EXPECT_NEAR(angle, length, 0.01 * length);  // the polyhedron is that much smaller
    EXPECT_LT(std::abs(start.cross(frame.on_surface.col(0)).normalized().dot(x)), 0.02);
    EXPECT_LT((lift.point(x, end) - x).norm(), 0.01);
  }
  EXPECT_LT((lift.point(lift.walk(start, face, Vector3d::Zero()), face) - p).norm(), 1e-12);
}

TEST(MeshLift, FrameIsTheDerivativeOfTheLift) {
  TriangleMesh mesh = shapes::icosphere(2);
  const MatrixX3d X = mesh.V;
  mesh.V.col(0) *= 3;
  Eigen::MatrixXd fields(mesh.vertex_count(), 2);
  fields << mesh.V.col(1), mesh.V.col(2).cwiseAbs2();
  const MeshLift lift(mesh, X, &fields);
  const Vector3d x = Vector3d(0.2, 0.6, -0.5).normalized();
  int face = 0;
  const Vector3d y = lift.point(x, face);
  const Lift::Frame frame = lift.frame(x, face);
  const Lift::Rates rates = lift.rates(face);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 2; ++k) {
    const Vector3d moved = (x + kStep * frame.on_sphere.col(k)).normalized();
    int same = face;
    EXPECT_LT(((lift.point(moved, same) - y) / kStep - frame.on_surface.col(k)).norm(), 1e-4);
    ASSERT_EQ(same, face);
    const Lift::Values change = (lift.values(moved, face) - lift.values(x, face)) / kStep;
    EXPECT_LT((change - rates.col(k)).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace crosspatch
