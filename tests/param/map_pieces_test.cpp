#include "param/map_pieces.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

TEST(MapPieces, AreTheIdentityInThePlane) {
  const TriangleMesh a = shapes::jittered_grid(shapes::grid(6), 6, 1);
  const TriangleMesh b = shapes::jittered_grid(shapes::grid(5), 5, 2);
  const MapPieces pieces(shapes::planar_overlay(a, b), a, b);
  for (int f = 0; f < a.face_count(); ++f) {
    const SurfacePoint p{f, Vector3d(0.5, 0.2, 0.3)};
    const SurfacePoint q = pieces.image(p);
    ASSERT_TRUE(q.valid());
    EXPECT_LT((position(a, p) - position(b, q)).norm(), 1e-9);
    // A segment comes out in one piece, each chord inside one face, and cut wherever an edge of b
    // is crossed.
    const Vector3d from(1, 0, 0), to(0, 0.4, 0.6);
    double reached = 0;
    for (const ImageChord& chord : pieces.image(f, from, to)) {
      EXPECT_NEAR(chord.begin, reached, 1e-9);
      EXPECT_EQ(chord.from.face, chord.to.face);
      const Vector3d expected = position(a, {f, from + chord.end * (to - from)});
      EXPECT_LT((expected - position(b, chord.to)).norm(), 1e-9);
      reached = chord.end;
    }
    EXPECT_NEAR(reached, 1, 1e-9);
  }
}

TEST(MapPieces, HaveNoImageWhereNothingIsMapped) {
  const TriangleMesh mesh = shapes::grid(2);
  SurfaceMap map = identity_map(mesh);
  map.polygon_begin.pop_back();  // the last face is left out
  map.source_face.pop_back();
  map.target_face.pop_back();
  const MapPieces pieces(map, mesh, mesh);
  const Vector3d middle = Vector3d::Constant(1.0 / 3);
  EXPECT_FALSE(pieces.image({mesh.face_count() - 1, middle}).valid());
  EXPECT_TRUE(pieces.image({mesh.face_count() - 2, middle}).valid());
  EXPECT_TRUE(pieces.image(mesh.face_count() - 1, middle, Vector3d::UnitX()).empty());
  // A corner of the face that is left out belongs to its neighbours too.
  EXPECT_TRUE(pieces.image({mesh.face_count() - 1, Vector3d::UnitX()}).valid());
}

}  // namespace
}  // namespace crosspatch
