#pragma once

#include <string>
#include <vector>

#include "core/mesh.hpp"
#include "core/soup.hpp"
#include "core/surface_point.hpp"

namespace crosspatch {

/// How a prepared mesh relates to the file it came from. Repair inside never leaks into files we
/// write: those speak of file vertices and file triangles (polygons fanned, see PolygonSoup).
struct FileNumbering {
  std::vector<int> mesh_vertex;    ///< per file vertex: its mesh vertex, or -1 (left out)
  std::vector<int> file_triangle;  ///< per mesh face, ascending
  std::vector<int> soup_corner;    ///< 3 per mesh face: corner of the soup at mesh corner 3 f + k
  std::vector<int> triangle_corners;  ///< 3 per file triangle: the soup's corners in fan order
};

/// A checked, connected, oriented manifold mesh made of a soup, with all that was changed on the
/// way.
struct PreparedMesh {
  TriangleMesh mesh;
  FileNumbering numbering;
  std::vector<std::string> repairs;  ///< one line each, the soup's notes first: "welded 12
                                     ///< vertices", "left out 3 of 4 components (2 % of area)", ...
};

struct PrepareOptions {
  double weld_distance =
      0;  ///< relative to the bounding box diagonal; 0 = identical positions only
};

/// Makes the soup one oriented manifold:
/// 1. welds vertices at the same place, but only those on the boundary of the file's own
///    connectivity: they are seams, while two closed sheets that touch stay apart;
/// 2. fans polygons, leaves out triangles that repeat a vertex and copies of another triangle;
/// 3. cuts edges where more than two triangles meet, keeping the sides of a solid, or else
///    the flattest pair, together;
/// 4. turns triangles to agree with their neighbours (the smaller area yields; a one-sided surface
///    is cut) and a closed surface so that its volume is positive;
/// 5. gives every fan of triangles a vertex of its own and keeps the component of largest area.
/// A clean file keeps its numbering: mesh vertex i is file vertex i, face f file triangle f.
/// kBadInput when no triangle with area is left, a coordinate is not finite, or an index is out of
/// range.
Result<PreparedMesh> prepare(const PolygonSoup& soup, const PrepareOptions& options = {});

/// A point of the mesh in the file's numbering: face is the file triangle, bary refers to its fan
/// order. An invalid point stays invalid.
SurfacePoint to_file(const PreparedMesh& prepared, const SurfacePoint& p);

/// The inverse of to_file; face == -1 where the file's triangle was left out or does not exist.
SurfacePoint from_file(const PreparedMesh& prepared, const SurfacePoint& p);

}  // namespace crosspatch
