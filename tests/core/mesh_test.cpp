#include "core/mesh.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace crosspatch {
namespace {

TEST(Mesh, EulerCharacteristicAndGenusOfKnownShapes) {
  EXPECT_EQ(euler_characteristic(shapes::tetrahedron()), 2);
  EXPECT_EQ(euler_characteristic(shapes::icosphere(2)), 2);
  EXPECT_EQ(euler_characteristic(shapes::torus(2, 1, 12, 8)), 0);
  EXPECT_EQ(genus(shapes::torus(2, 1, 12, 8)), 1);
  EXPECT_EQ(genus(shapes::grid(3)), 0);
  EXPECT_EQ(boundary_loops(shapes::grid(3)).size(), 1u);
  EXPECT_EQ(boundary_loops(shapes::grid(3))[0].size(), 12u);
}

TEST(Mesh, KnownShapesAreValid) {
  for (const TriangleMesh& mesh :
       {shapes::tetrahedron(), shapes::icosphere(2), shapes::grid(4), shapes::torus(2, 1, 9, 7)})
    EXPECT_TRUE(validate(mesh)) << validate(mesh).error().message;
}

TEST(Mesh, OneRingOfABoundaryVertexIsComplete) {
  const TriangleMesh mesh = shapes::grid(3);
  int corners = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v) for_each_outgoing(mesh, v, [&](int) { ++corners; });
  EXPECT_EQ(corners, mesh.halfedge_count());
}

TEST(Mesh, BadConnectivityIsNamed) {
  MatrixX3d V = MatrixX3d::Zero(5, 3);
  const auto message = [&](std::initializer_list<std::array<int, 3>> faces) {
    MatrixX3i F(static_cast<int>(faces.size()), 3);
    int i = 0;
    for (const auto& f : faces) F.row(i++) << f[0], f[1], f[2];
    const auto mesh = make_mesh(V, F);
    return mesh ? std::string("accepted") : mesh.error().message;
  };
  EXPECT_EQ(message({{0, 1, 9}}), "face 0: vertex 9 is outside [0, 5)");
  EXPECT_EQ(message({{0, 1, 1}}), "face 0: vertex 1 is repeated");
  EXPECT_EQ(message({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}),
            "edge (0, 1): 3 faces meet there, at most 2 can");
  EXPECT_EQ(message({{0, 1, 2}, {0, 1, 3}}),
            "edge (0, 1): its two faces have opposite orientations");
  EXPECT_EQ(message({{0, 1, 2}, {0, 3, 4}}), "vertex 0: its 2 faces are not one fan (1 reached)");
  EXPECT_EQ(message({{0, 1, 2}}), "vertex 3: no face uses it");
}

TEST(Mesh, NormalizedHasUnitArea) {
  const TriangleMesh mesh = normalized(shapes::torus(3, 1, 20, 10));
  EXPECT_NEAR(total_area(mesh), 1, 1e-12);  // rounding only
}

}  // namespace
}  // namespace crosspatch
