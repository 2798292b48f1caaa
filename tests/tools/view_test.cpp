#include "tools/view.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"
#include "tools/scene_surface.hpp"

namespace crosspatch {
namespace {

constexpr double kRounding = 1e-12;

TEST(View, FramesAreRotations) {
  const MatrixX3d points = shapes::torus(3, 1, 11, 7).V;
  for (const Frame& frame :
       {axis_frame('x'), axis_frame('y'), axis_frame('z'), principal_frame(points)})
    for (const char* name : {"front", "back", "left", "right", "top", "bottom", "quarter"}) {
      const Eigen::Matrix3d axes = view_axes(frame, parse_view(name).value());
      EXPECT_LT((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm(), kRounding);
      EXPECT_GT(axes.determinant(), 0);
      EXPECT_EQ(view_name(parse_view(name).value()), name);
    }
}

TEST(View, LooksFromTheNamedSide) {
  const auto viewer = [](const char* name, char up) -> Vector3d {
    return view_axes(axis_frame(up), parse_view(name).value()).row(2).transpose();
  };
  EXPECT_LT((viewer("front", 'y') - Vector3d(0, 0, 1)).norm(), kRounding);
  EXPECT_LT((viewer("right", 'y') - Vector3d(1, 0, 0)).norm(), kRounding);
  EXPECT_LT((viewer("top", 'y') - Vector3d(0, 1, 0)).norm(), kRounding);
  EXPECT_LT((viewer("front", 'z') - Vector3d(0, -1, 0)).norm(), kRounding);
  EXPECT_LT((viewer("top", 'z') - Vector3d(0, 0, 1)).norm(), kRounding);
  EXPECT_LT((viewer("top", 'x') - Vector3d(1, 0, 0)).norm(), kRounding);
  EXPECT_LT((viewer("side", 'y') - viewer("right", 'y')).norm(), kRounding);
  EXPECT_EQ(parse_view("above").error().message,
            "view 'above': known are front, back, left, right, side, top, bottom, quarter");
}

TEST(View, PrincipalFrameFollowsTheExtents) {
  const MatrixX3d points = shapes::icosphere(2).V * Vector3d(1, 5, 2).asDiagonal();
  const Frame frame = principal_frame(points);
  EXPECT_LT((frame.row(0) - Eigen::RowVector3d(0, 1, 0)).norm(), 1e-9);
  EXPECT_LT((frame.row(1) - Eigen::RowVector3d(0, 0, 1)).norm(), 1e-9);
}

TEST(View, BestRotationIsFoundAndNeverMirrors) {
  const MatrixX3d points = shapes::torus(3, 1, 11, 7).V * Vector3d(1, 2, 3).asDiagonal();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const MatrixX3d turned = ((points * turn.transpose()).rowwise() + Eigen::RowVector3d(4, 5, 6));
  EXPECT_LT((best_rotation(points, turned) - turn).norm(), 1e-9);
  const MatrixX3d mirrored = points * Vector3d(-1, 1, 1).asDiagonal();
  EXPECT_NEAR(best_rotation(points, mirrored).determinant(), 1, kRounding);
}

TEST(View, FittedThingsFillTheirPicture) {
  Scene scene;
  const TriangleMesh sphere = shapes::icosphere(4);
  scene.surfaces.push_back(
      make_surface(sphere.V.rowwise() + Eigen::RowVector3d(7, -8, 9), sphere.F));
  const Camera camera = fit_camera(scene, Eigen::Matrix3d::Identity(), 300, 100, 10);
  EXPECT_NEAR(
      camera.pixel_size, 2.0 / 80, 1e-4);  // the icosphere's corners miss the poles a little
  EXPECT_LT((camera.centre - Vector3d(7, -8, 9)).norm(), 1e-9);
}

}  // namespace
}  // namespace crosspatch
