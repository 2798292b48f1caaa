#include "transfer/triangulate.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace crosspatch {
namespace {

const std::array<Vector2d, 3> kFrame{Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1)};

Vector3d at(double x, double y) {
  return {1 - x - y, x, y};
}

double area_of(const std::vector<Vector3d>& polygon,
               const std::vector<std::array<int, 3>>& triangles) {
  return std::accumulate(triangles.begin(), triangles.end(), 0.0, [&](double sum, const auto& t) {
    const auto corner = [&](int k) {
      return polygon[static_cast<std::size_t>(t.at(static_cast<std::size_t>(k)))];
    };
    return sum + signed_area(corner(0), corner(1), corner(2));
  });
}

TEST(Triangulate, ConvexPolygonIsFilled) {
  const std::vector<Vector3d> polygon{at(.1, .1), at(.5, .1), at(.5, .4), at(.1, .4)};
  const auto triangles = triangulate(polygon, kFrame);
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_NEAR(area_of(polygon, triangles), 2 * .4 * .3, 1e-12);  // relative to a face of area 1/2
}

TEST(Triangulate, ReflexCornerStaysOutside) {
  // An arrow head: area of the hull triangle less the notch.
  const std::vector<Vector3d> polygon{at(0, 0), at(.4, .1), at(.8, 0), at(.4, .6)};
  const auto triangles = triangulate(polygon, kFrame);
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_NEAR(area_of(polygon, triangles), .8 * .6 - .8 * .1, 1e-12);
}

TEST(Triangulate, CornersOnAStraightEdgeGiveNoFlatTriangle) {
  // Points on the face's slanted edge: their weight for corner 0 is exactly zero.
  const std::vector<Vector3d> polygon{
      {1, 0, 0}, {0, 1, 0}, {0, .7, .3}, {0, 1. / 3, 2. / 3}, {0, .1, .9}, {0, 0, 1}};
  const auto triangles = triangulate(polygon, kFrame);
  ASSERT_EQ(triangles.size(), 4u);
  for (const auto& t : triangles)
    EXPECT_GT(signed_area(polygon[static_cast<std::size_t>(t[0])],
                          polygon[static_cast<std::size_t>(t[1])],
                          polygon[static_cast<std::size_t>(t[2])]),
              0.05);
  EXPECT_NEAR(area_of(polygon, triangles), 1, 1e-12);
}

TEST(Triangulate, FlatAndTurnedPolygonsAreRefused) {
  EXPECT_TRUE(triangulate({{0, 1, 0}, {0, .5, .5}, {0, 0, 1}}, kFrame).empty());
  EXPECT_TRUE(triangulate({at(0, 0), at(0, 1), at(1, 0)}, kFrame).empty());
}

TEST(LayFlat, KeepsLengthsAndOrientation) {
  const Vector3d a(1, 2, 3), b(2, 0, 1), c(-1, 1, 2);
  const auto flat = lay_flat(a, b, c);
  EXPECT_NEAR((flat[1] - flat[0]).norm(), (b - a).norm(), 1e-12);
  EXPECT_NEAR((flat[2] - flat[1]).norm(), (c - b).norm(), 1e-12);
  EXPECT_NEAR((flat[0] - flat[2]).norm(), (a - c).norm(), 1e-12);
  EXPECT_GT(flat[2][1], 0);
}

}  // namespace
}  // namespace crosspatch
