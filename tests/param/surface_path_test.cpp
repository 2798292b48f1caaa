#include "param/surface_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shapes.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

double length(const TriangleMesh& mesh, const std::vector<FaceSegment>& path) {
  double sum = 0;
  for (const FaceSegment& s : path)
    sum += (position(mesh, {s.face, s.to}) - position(mesh, {s.face, s.from})).norm();
  return sum;
}

/// Where the path is torn, or -1.
int torn_at(const TriangleMesh& mesh,
            const std::vector<FaceSegment>& path,
            const SurfacePoint& from,
            const SurfacePoint& to) {
  Vector3d at = position(mesh, from);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if ((position(mesh, {path[i].face, path[i].from}) - at).norm() > 1e-12)
      return static_cast<int>(i);
    at = position(mesh, {path[i].face, path[i].to});
  }
  return (position(mesh, to) - at).norm() > 1e-12 ? static_cast<int>(path.size()) : -1;
}

TEST(SurfacePaths, AreStraightOnAPlane) {
  const TriangleMesh mesh = shapes::jittered_grid(shapes::grid(12), 12, 3);
  SurfacePaths paths(mesh);
  for (int f = 0; f < 40; f += 3)
    for (int g = 250; g < 288; g += 5) {
      const SurfacePoint a{f, Vector3d(0.2, 0.3, 0.5)}, b{g, Vector3d(0.6, 0.3, 0.1)};
      const auto path = paths.path(a, b);
      EXPECT_EQ(torn_at(mesh, path, a, b), -1);
      // The search may take the wrong side of a vertex that lies near the line; it then touches it.
      const double straight = (position(mesh, b) - position(mesh, a)).norm();
      EXPECT_GE(length(mesh, path), straight - 1e-12);
      EXPECT_LT(length(mesh, path), 1.01 * straight);
    }
}

TEST(SurfacePaths, FollowGreatCircles) {
  const TriangleMesh mesh = shapes::icosphere(4);
  SurfacePaths paths(mesh);
  for (int v = 1; v < mesh.vertex_count(); v += 211) {
    const SurfacePoint a = point_at_vertex(mesh, 0), b = point_at_vertex(mesh, v);
    const auto path = paths.path(a, b);
    EXPECT_EQ(torn_at(mesh, path, a, b), -1);
    const double arc = std::acos(std::clamp(mesh.position(0).dot(mesh.position(v)), -1.0, 1.0));
    // The mesh lies inside the sphere by about its edge squared over 8.
    EXPECT_NEAR(length(mesh, path) / arc, 1, 0.01);
  }
}

TEST(SurfacePaths, JoinPointsOfOneFaceStraight) {
  const TriangleMesh mesh = shapes::tetrahedron();
  SurfacePaths paths(mesh);
  const SurfacePoint a{0, Vector3d(1, 0, 0)}, b{0, Vector3d(0, 0.5, 0.5)};
  const auto path = paths.path(a, b);
  ASSERT_EQ(path.size(), 1u);
  EXPECT_EQ(torn_at(mesh, path, a, b), -1);
  EXPECT_TRUE(paths.path(a, a).empty());
}

TEST(FacesAt, CountsThoseThatHoldThePoint) {
  const TriangleMesh mesh = shapes::icosphere(1);
  EXPECT_EQ(faces_at(mesh, {3, Vector3d(0.2, 0.3, 0.5)}).size(), 1u);
  EXPECT_EQ(faces_at(mesh, {3, Vector3d(0.5, 0, 0.5)}).size(), 2u);
  EXPECT_EQ(faces_at(mesh, point_at_vertex(mesh, 0)).size(), 5u);   // of the icosahedron
  EXPECT_EQ(faces_at(mesh, point_at_vertex(mesh, 41)).size(), 6u);  // the middle of its edge
  const TriangleMesh open = shapes::grid(1);
  EXPECT_EQ(faces_at(open, {0, Vector3d(0.5, 0.5, 0)}).size(), 1u);
  EXPECT_EQ(faces_at(open, point_at_vertex(open, 0)).size(), 2u);
}

}  // namespace
}  // namespace crosspatch
