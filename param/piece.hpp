#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/surface_point.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// A mesh made of pieces of the faces of another one, its parent.
struct Piece {
  TriangleMesh mesh;
  std::vector<SurfacePoint> origin;  ///< per vertex: where it lies on the parent
  std::vector<int> parent_face;      ///< per face
  std::vector<int> point;            ///< per vertex: the overlay's point there, or -1
};

/// A polygon that is to become part of a piece.
struct PiecePolygon {
  std::vector<int> corners;  ///< counter-clockwise
  int face = -1;             ///< of the parent
};

/// Vertices to be put on sides of polygons, in the order from the first corner to the second.
using SidePoints = std::map<std::pair<int, int>, std::vector<int>>;

/// The corners of a polygon with vertices put on its sides, whichever way the sides are listed.
std::vector<int> with_points(const std::vector<int>& corners, const SidePoints& between);

/// Polygons as triangles: those with more than three corners are cut around a vertex in their
/// middle. `origin` and `point`: per vertex, as in Piece. Errors of make_mesh.
Result<Piece> triangulate(const TriangleMesh& parent,
                          const std::vector<PiecePolygon>& polygons,
                          std::vector<SurfacePoint> origin,
                          std::vector<int> point);

/// The piece with more vertices on its edges; `between` holds numbers that follow on the piece's
/// own, `added` their places.
Result<Piece> with_points(const TriangleMesh& parent,
                          const Piece& piece,
                          const SidePoints& between,
                          const std::vector<SurfacePoint>& added);

/// A point of half-edge h, a share of the way along.
SurfacePoint on_edge(const TriangleMesh& parent, const Piece& piece, int h, double share);

/// Splits every inner edge that joins two boundary vertices.
Result<Piece> without_chords(const TriangleMesh& parent, const Piece& piece);

}  // namespace crosspatch
