#include "core/intrinsic.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace crosspatch {
namespace {

double area(const IntrinsicMesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += face_area(mesh, f);
  return sum;
}

/// Sheared so far that many edges are not Delaunay.
TriangleMesh sheared(TriangleMesh mesh) {
  for (int v = 0; v < mesh.vertex_count(); ++v) mesh.V(v, 0) += 2.3 * mesh.V(v, 1);
  return mesh;
}

TEST(Intrinsic, AreaFromLengthsIsThatOfTheMesh) {
  const TriangleMesh mesh = shapes::torus(2, 1, 12, 8);
  EXPECT_NEAR(area(intrinsic_mesh(mesh)), total_area(mesh), 1e-12 * total_area(mesh));  // rounding
}

TEST(Intrinsic, FlipsKeepAreaAndEndDelaunay) {
  for (const TriangleMesh& mesh : {sheared(shapes::grid(8)), sheared(shapes::torus(2, 1, 40, 9))}) {
    IntrinsicMesh surface = intrinsic_mesh(mesh);
    const double before = area(surface);
    EXPECT_GT(make_delaunay(surface), 0);
    EXPECT_NEAR(area(surface), before, 1e-10 * before);  // rounding over all flips
    for (int h = 0; h < surface.halfedge_count(); ++h) {
      const int t = surface.twin[static_cast<size_t>(h)];
      if (t < 0) continue;
      EXPECT_EQ(surface.twin[static_cast<size_t>(t)], h);
      EXPECT_GE(cotangent(surface, h) + cotangent(surface, t), -1e-8);  // slack of the flip test
    }
  }
}

TEST(Intrinsic, MollifyingOpensACollapsedTriangle) {
  MatrixX3d V(4, 3);
  V << 0, 0, 0, 1, 0, 0, 0.5, 0, 0, 0.5, 1, 0;  // vertex 2 lies on the edge 0-1
  MatrixX3i F(2, 3);
  F << 0, 2, 1, 0, 1, 3;
  IntrinsicMesh surface = intrinsic_mesh(make_mesh(V, F).value());
  EXPECT_EQ(face_area(surface, 0), 0);
  const double added = mollify(surface, 1e-4);
  EXPECT_GT(added, 0);
  EXPECT_GT(face_area(surface, 0), 0);
  EXPECT_EQ(mollify(surface, 1e-5), 0);  // already slack enough
}

}  // namespace
}  // namespace crosspatch
