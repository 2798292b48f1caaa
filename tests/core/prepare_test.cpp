#include "core/prepare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/index.hpp"
#include "shapes.hpp"

namespace crosspatch {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

PolygonSoup soup_of(const MatrixX3d& V, const std::vector<std::vector<int>>& polygons) {
  PolygonSoup soup;
  soup.positions = V;
  for (const auto& polygon : polygons) {
    soup.corner_vertex.insert(soup.corner_vertex.end(), polygon.begin(), polygon.end());
    soup.polygon_begin.push_back(soup.corner_count());
  }
  return soup;
}

PolygonSoup soup_of(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> polygons;
  for (int f = 0; f < mesh.face_count(); ++f)
    polygons.push_back({mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)});
  return soup_of(mesh.V, polygons);
}

/// Every corner of the mesh lies where the file has it; every number is in range.
void expect_consistent(const PreparedMesh& p, const PolygonSoup& soup) {
  ASSERT_TRUE(validate(p.mesh)) << validate(p.mesh).error().message;
  const FileNumbering& n = p.numbering;
  ASSERT_EQ(n.file_triangle.size(), static_cast<std::size_t>(p.mesh.face_count()));
  ASSERT_EQ(n.soup_corner.size(), static_cast<std::size_t>(p.mesh.halfedge_count()));
  ASSERT_EQ(n.mesh_vertex.size(), static_cast<std::size_t>(soup.positions.rows()));
  EXPECT_EQ(n.triangle_corners, fan_triangle_corners(soup));
  for (int h = 0; h < p.mesh.halfedge_count(); ++h) {
    const int file_vertex = soup.corner_vertex[idx(n.soup_corner[idx(h)])];
    EXPECT_EQ(soup.positions.row(file_vertex), p.mesh.V.row(p.mesh.from(h)));
    EXPECT_GE(n.mesh_vertex[idx(file_vertex)], 0);
  }
  for (int v = 0; v < soup.positions.rows(); ++v) {
    const int m = n.mesh_vertex[idx(v)];
    EXPECT_TRUE(m < 0 || soup.positions.row(v) == p.mesh.V.row(m));
  }
  for (int f = 0; f < p.mesh.face_count(); ++f) {
    const SurfacePoint inside{f, {0.5, 0.3, 0.2}};
    const SurfacePoint file = to_file(p, inside);
    Vector3d position = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      position +=
          file.bary[k] *
          soup.positions.row(soup.corner_vertex[idx(n.triangle_corners[idx(3 * file.face + k)])])
              .transpose();
    EXPECT_LT((position - crosspatch::position(p.mesh, inside)).norm(), 1e-12);  // rounding
    const SurfacePoint back = from_file(p, file);
    EXPECT_EQ(back.face, f);
    EXPECT_EQ(back.bary, inside.bary);
  }
}

PreparedMesh prepared(const PolygonSoup& soup, const PrepareOptions& options = {}) {
  auto p = prepare(soup, options);
  EXPECT_TRUE(p) << p.error().message;
  if (!p) return {};
  expect_consistent(*p, soup);
  return std::move(*p);
}

TEST(Prepare, CleanMeshKeepsItsNumbersAndNeedsNoRepair) {
  for (const TriangleMesh& mesh :
       {shapes::tetrahedron(), shapes::icosphere(2), shapes::grid(4), shapes::torus(2, 1, 9, 7)}) {
    const PreparedMesh p = prepared(soup_of(mesh));
    EXPECT_EQ(p.mesh.V, mesh.V);
    EXPECT_EQ(p.mesh.F, mesh.F);
    EXPECT_THAT(p.repairs, IsEmpty());
  }
}

TEST(Prepare, NotesOfTheReaderComeFirst) {
  PolygonSoup soup = soup_of(shapes::tetrahedron());
  soup.notes = {"image passed over"};
  EXPECT_THAT(prepared(soup).repairs, ElementsAre("image passed over"));
}

TEST(Prepare, SoupOfLooseTrianglesIsWelded) {
  const TriangleMesh mesh = shapes::torus(2, 1, 9, 7);
  MatrixX3d V(3 * mesh.face_count(), 3);
  std::vector<std::vector<int>> polygons;
  for (int h = 0; h < mesh.halfedge_count(); ++h) V.row(h) = mesh.V.row(mesh.from(h));
  for (int f = 0; f < mesh.face_count(); ++f) polygons.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  const PreparedMesh p = prepared(soup_of(V, polygons));
  EXPECT_EQ(p.mesh.vertex_count(), mesh.vertex_count());
  EXPECT_EQ(genus(p.mesh), 1);
  // 3 * 126 corners, 63 vertices
  EXPECT_THAT(p.repairs, ElementsAre("welded 315 vertices to others at the same place"));
}

TEST(Prepare, WeldDistanceClosesNarrowSeams) {
  // Two squares side by side, 1e-6 apart.
  MatrixX3d V(8, 3);
  V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1 + 1e-6, 0, 0, 2, 0, 0, 2, 1, 0, 1 + 1e-6, 1, 0;
  const PolygonSoup soup = soup_of(V, {{0, 1, 2, 3}, {4, 5, 6, 7}});
  EXPECT_EQ(prepared(soup).mesh.face_count(), 2);
  const auto p = prepare(soup, {.weld_distance = 1e-5});
  ASSERT_TRUE(p);
  EXPECT_TRUE(validate(p->mesh));
  EXPECT_EQ(p->mesh.face_count(), 4);
  EXPECT_EQ(p->mesh.vertex_count(), 6);
  EXPECT_EQ(p->numbering.mesh_vertex[4], p->numbering.mesh_vertex[1]);
  EXPECT_FALSE(prepare(soup, {.weld_distance = 0.5}));
  EXPECT_FALSE(prepare(soup, {.weld_distance = -1}));
}

TEST(Prepare, ClosedSheetsThatTouchStayApart) {
  // Two tetrahedra that share the position of one vertex, each with a vertex of its own there.
  const TriangleMesh one = shapes::tetrahedron();
  MatrixX3d V(8, 3);
  V << one.V, (3 * one.V).rowwise() - 2 * one.V.row(0);
  std::vector<std::vector<int>> polygons;
  for (const int shift : {0, 4})
    for (int f = 0; f < 4; ++f)
      polygons.push_back({one.F(f, 0) + shift, one.F(f, 1) + shift, one.F(f, 2) + shift});
  const PreparedMesh p = prepared(soup_of(V, polygons));
  // Areas 1 : 9.
  EXPECT_THAT(p.repairs, ElementsAre("left out 1 of 2 components (10 % of area, 4 triangles)"));
  EXPECT_EQ(p.numbering.mesh_vertex[0], -1);
  EXPECT_EQ(p.numbering.mesh_vertex[4], 0);
}

TEST(Prepare, PolygonsAreFannedAndShortOnesLeftOut) {
  MatrixX3d V(5, 3);
  V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 9, 9, 9;
  const PreparedMesh p = prepared(soup_of(V, {{0, 1}, {0, 1, 2, 3}, {}}));
  EXPECT_EQ(p.numbering.file_triangle, (std::vector<int>{0, 1}));
  EXPECT_EQ(p.numbering.soup_corner, (std::vector<int>{2, 3, 4, 2, 4, 5}));
  EXPECT_THAT(p.repairs,
              ElementsAre("left out 2 polygons of fewer than three corners",
                          "cut 1 polygons of more than three corners into fans of triangles",
                          "left out 1 vertices that no triangle uses"));
}

TEST(Prepare, RepeatedVerticesAndCopiesAreLeftOut) {
  const TriangleMesh mesh = shapes::icosphere(1);
  PolygonSoup soup = soup_of(mesh);
  for (const std::vector<int>& extra :
       {std::vector<int>{0, 0, 1}, {mesh.F(5, 1), mesh.F(5, 2), mesh.F(5, 0)}, {3, 3, 3}}) {
    soup.corner_vertex.insert(soup.corner_vertex.end(), extra.begin(), extra.end());
    soup.polygon_begin.push_back(soup.corner_count());
  }
  const PreparedMesh p = prepared(soup);
  EXPECT_EQ(p.mesh.F, mesh.F);
  EXPECT_THAT(p.repairs,
              ElementsAre("left out 2 triangles that repeat a vertex",
                          "left out 1 copies of other triangles"));
}

TEST(Prepare, MixedOrientationIsMadeConsistent) {
  const TriangleMesh mesh = shapes::torus(2, 1, 12, 8);
  for (unsigned seed = 0; seed < 4; ++seed) {
    std::mt19937 random(seed);
    PolygonSoup soup = soup_of(mesh);
    for (int f = 0; f < mesh.face_count(); ++f)
      if (random() % 4 == 0)
        std::swap(soup.corner_vertex[idx(3 * f)], soup.corner_vertex[idx(3 * f + 1)]);
    const PreparedMesh p = prepared(soup);
    EXPECT_EQ(p.mesh.face_count(), mesh.face_count());
    EXPECT_EQ(genus(p.mesh), 1);
    EXPECT_EQ(p.repairs.size(), 1u);
  }
}

TEST(Prepare, InsideOutClosedSurfaceIsTurnedAnOpenOneIsNot) {
  TriangleMesh mesh = shapes::icosphere(1);
  mesh.F.col(0).swap(mesh.F.col(1));
  const PreparedMesh p = prepared(soup_of(mesh));
  EXPECT_THAT(p.repairs, ElementsAre("turned the closed surface, its volume was negative"));
  const Vector3d a = p.mesh.position(p.mesh.F(0, 0)), b = p.mesh.position(p.mesh.F(0, 1)),
                 c = p.mesh.position(p.mesh.F(0, 2));
  EXPECT_GT(a.dot(b.cross(c)), 0);
  TriangleMesh open = shapes::grid(2);
  open.F.col(0).swap(open.F.col(1));
  EXPECT_THAT(prepared(soup_of(open)).repairs, IsEmpty());
}

TEST(Prepare, FinOnASurfaceIsCutOff) {
  const TriangleMesh mesh = shapes::icosphere(1);
  MatrixX3d V(mesh.vertex_count() + 1, 3);
  V << mesh.V, 1.5 * (mesh.V.row(mesh.F(0, 0)) + mesh.V.row(mesh.F(0, 1)));
  PolygonSoup soup = soup_of(mesh);
  soup.positions = V;
  for (const int v : {mesh.F(0, 0), mesh.F(0, 1), mesh.vertex_count()})
    soup.corner_vertex.push_back(v);
  soup.polygon_begin.push_back(soup.corner_count());
  const PreparedMesh p = prepared(soup);
  EXPECT_EQ(p.mesh.F, mesh.F);
  EXPECT_EQ(p.repairs[0], "cut 1 edges where more than two triangles meet");
  EXPECT_EQ(p.numbering.mesh_vertex.back(), -1);
}

TEST(Prepare, TetrahedraSharingAnEdgeAreParted) {
  MatrixX3d V(6, 3);
  V << 0, 0, -1, 0, 0, 1, 1, 0.3, 0, 1, -0.3, 0, -1, 0.3, 0, -1, -0.3, 0;
  const PreparedMesh p = prepared(soup_of(
      V, {{0, 1, 2}, {1, 0, 3}, {1, 3, 2}, {0, 2, 3}, {1, 0, 4}, {0, 1, 5}, {0, 5, 4}, {1, 4, 5}}));
  EXPECT_EQ(euler_characteristic(p.mesh), 2);
  EXPECT_TRUE(boundary_loops(p.mesh).empty());
}

TEST(Prepare, BowTieVertexIsSplit) {
  // Two fans that meet in vertex 0, joined elsewhere by a strip: one component.
  MatrixX3d V(6, 3);
  V << 0, 0, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, -1, -1, 0, 0, 3, 0;
  const PreparedMesh p = prepared(soup_of(V, {{0, 1, 2}, {0, 3, 4}, {2, 5, 3}, {2, 3, 5}}));
  EXPECT_TRUE(validate(p.mesh));
  const PreparedMesh q =
      prepared(soup_of(V, {{0, 1, 2}, {0, 3, 4}, {1, 5, 2}, {5, 4, 3}, {1, 4, 5}}));
  EXPECT_EQ(q.mesh.vertex_count(), 7);
  EXPECT_THAT(q.repairs,
              testing::Contains("split 1 vertices where several fans of triangles meet"));
}

TEST(Prepare, MoebiusStripIsCutOnce) {
  const int n = 12;
  MatrixX3d V(2 * n, 3);
  std::vector<std::vector<int>> polygons;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * std::numbers::pi * i / n;
    for (const int side : {0, 1}) {
      const double r = 2 + (side - 0.5) * std::cos(u / 2);
      V.row(2 * i + side) << r * std::cos(u), r * std::sin(u), (side - 0.5) * std::sin(u / 2);
    }
    const bool last = i == n - 1;  // joined upside down
    const int a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    polygons.push_back({a, c, d});
    polygons.push_back({a, d, b});
  }
  const PreparedMesh p = prepared(soup_of(V, polygons));
  EXPECT_EQ(p.mesh.face_count(), 2 * n);
  EXPECT_EQ(euler_characteristic(p.mesh), 1);  // a disc
  EXPECT_THAT(p.repairs, testing::Contains("cut 1 edges of a one-sided surface"));
}

TEST(Prepare, RandomSoupsAlwaysEndAsManifolds) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const int n = 4 + static_cast<int>(random() % 6);
    MatrixX3d V(n, 3);
    for (int v = 0; v < n; ++v)
      V.row(v) << static_cast<int>(random() % 5), static_cast<int>(random() % 5),
          static_cast<int>(random() % 5);
    std::vector<std::vector<int>> polygons(4 + random() % 40);
    for (auto& polygon : polygons)
      for (unsigned k = 0; k < 2 + random() % 4; ++k)
        polygon.push_back(static_cast<int>(random() % static_cast<unsigned>(n)));
    const PolygonSoup soup = soup_of(V, polygons);
    const auto p = prepare(soup);
    if (p)
      expect_consistent(*p, soup);
    else
      EXPECT_EQ(p.error().code, ErrorCode::kBadInput) << seed << p.error().message;
  }
}

TEST(Prepare, WhatCannotBeUsedIsNamed) {
  const auto message = [](const PolygonSoup& soup) {
    const auto p = prepare(soup);
    return p ? "accepted" : p.error().message;
  };
  MatrixX3d V = MatrixX3d::Zero(3, 3);
  EXPECT_EQ(message(soup_of(V, {{0, 1, 2}})), "no triangle with area is left");
  EXPECT_EQ(message(soup_of(MatrixX3d(0, 3), {})), "no triangle with area is left");
  EXPECT_EQ(message(soup_of(V, {{0, 1, 3}})),
            "polygon 0: vertex 3 (counted from 0) is outside [0, 3)");
  V << 0, 0, 0, 1e200, 0, 0, 0, 1e200, 0;
  EXPECT_EQ(message(soup_of(V, {{0, 1, 2}})), "coordinates too large: the area is not finite");
  V(1, 2) = NAN;
  EXPECT_EQ(message(soup_of(V, {{0, 1, 2}})),
            "vertex 1 (counted from 0): a coordinate is not finite");
}

}  // namespace
}  // namespace crosspatch
