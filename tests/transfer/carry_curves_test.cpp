#include "transfer/carry_curves.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "shapes.hpp"
#include "surfaces.hpp"

namespace crosspatch {
namespace {

double length(const TriangleMesh& mesh, const SurfaceCurve& curve) {
  double sum = 0;
  for (std::size_t i = 0; i + (curve.closed ? 0 : 1) < curve.points.size(); ++i)
    sum += (position(mesh, curve.points[(i + 1) % curve.points.size()]) -
            position(mesh, curve.points[i]))
               .norm();
  return sum;
}

TEST(CarryDrawing, CurvesInThePlaneStayWhereTheyAre) {
  const TriangleMesh a = shapes::jittered_grid(shapes::grid(7), 7, 1);
  const TriangleMesh b = shapes::jittered_grid(shapes::grid(6), 6, 2);
  const SurfaceMap map = shapes::planar_overlay(a, b);
  // Corners of the square: its outline is a closed curve of length 4.
  const auto corner = [&](int v) { return point_at_vertex(a, v); };
  const Drawing drawing{
      {{"middle", {50, Vector3d(0.2, 0.3, 0.5)}}, {"nowhere", {}}},
      {{"outline", true, {corner(0), corner(7), corner(63), corner(56)}},
       {"diagonal", false, {corner(0), {50, Vector3d(0.2, 0.3, 0.5)}, corner(63)}}}};
  const CarriedDrawing carried = carry_drawing(drawing, a, b, map);
  EXPECT_EQ(carried.unmapped_landmarks, 1);
  EXPECT_EQ(carried.gaps, 0);
  EXPECT_EQ(carried.paths, 6);
  const auto& [landmarks, curves] = carried.drawing;
  EXPECT_LT((position(b, landmarks[0].point) - position(a, drawing.landmarks[0].point)).norm(),
            1e-9);
  EXPECT_FALSE(landmarks[1].point.valid());
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_TRUE(curves[0].closed);
  EXPECT_NEAR(length(b, curves[0]), 4, 1e-6);
  EXPECT_FALSE(curves[1].closed);
  const Vector3d middle = position(a, drawing.landmarks[0].point);
  const double direct = middle.norm() + (Vector3d(1, 1, 0) - middle).norm();
  EXPECT_NEAR(length(b, curves[1]) / direct, 1, 0.01);
  EXPECT_LT((position(b, curves[1].points.front()) - a.position(0)).norm(), 1e-9);
  EXPECT_LT((position(b, curves[1].points.back()) - a.position(63)).norm(), 1e-9);
  for (const SurfaceCurve& curve : curves)
    for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
      const auto p = faces_at(b, curve.points[i]), q = faces_at(b, curve.points[i + 1]);
      EXPECT_TRUE(std::any_of(
          p.begin(), p.end(), [&](int f) { return std::find(q.begin(), q.end(), f) != q.end(); }))
          << curve.name << " leaves its triangle at " << i;
    }
}

TEST(CarryDrawing, CurvesAreCutWhereNothingIsMapped) {
  const TriangleMesh mesh = shapes::grid(4);
  SurfaceMap map = identity_map(mesh);
  SurfaceMap holed;
  holed.source = map.source;
  holed.target = map.target;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (f == 12) continue;  // a triangle of the second row: (0.5, 0.25) (0.75, 0.25) (0.75, 0.5)
    for (int k = 0; k < 3; ++k) holed.corner.push_back(mesh.F(f, k));
    holed.polygon_begin.push_back(static_cast<int>(holed.corner.size()));
    holed.source_face.push_back(f);
    holed.target_face.push_back(f);
  }
  holed.point_of_source_vertex = map.point_of_source_vertex;
  holed.point_of_target_vertex = map.point_of_target_vertex;
  // Across the square at a height of 0.3, in the triangles of the second row.
  const auto at = [&](double x) {
    for (int f = 8; f < 16; ++f) {
      const Vector3d bary = shapes::planar_barycentric(mesh, f, Vector2d(x, 0.3));
      if (bary.minCoeff() >= 0) return SurfacePoint{f, bary};
    }
    return SurfacePoint{};
  };
  const Drawing open{{}, {{"line", false, {at(0.1), at(0.9)}}}};
  const CarriedDrawing line = carry_drawing(open, mesh, mesh, holed);
  EXPECT_EQ(line.gaps, 1);
  ASSERT_EQ(line.drawing.curves.size(), 2u);
  // The gap reaches from the diagonal, at x = 0.55, to the side of the square, at 0.75.
  EXPECT_NEAR(length(mesh, line.drawing.curves[0]), 0.45, 1e-6);
  EXPECT_NEAR(length(mesh, line.drawing.curves[1]), 0.15, 1e-6);
  const Drawing ring{{}, {{"ring", true, {at(0.1), at(0.9), point_at_vertex(mesh, 22)}}}};
  const CarriedDrawing around = carry_drawing(ring, mesh, mesh, holed);
  EXPECT_EQ(around.gaps, 1);
  ASSERT_EQ(around.drawing.curves.size(), 1u) << "what is left of a ring is one curve";
  EXPECT_FALSE(around.drawing.curves[0].closed);
}

}  // namespace
}  // namespace crosspatch
