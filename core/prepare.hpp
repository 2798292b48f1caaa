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
  std::vector<int> file_triangle;  ///< per mesh face
  std::vector<int> soup_corner;    ///< 3 per mesh face: corner of the soup at mesh corner 3 f + k
  std::vector<int> triangle_corners;  ///< 3 per file triangle: the soup's corners in fan order
};

/// A checked, connected, oriented manifold mesh made of a soup, with all that was changed on the
/// way.
struct PreparedMesh {
  TriangleMesh mesh;
  FileNumbering numbering;
  std::vector<std::string> repairs;  ///< one line each: "welded 12 vertices", "left out 3 of 4
                                     ///< components (2 % of area)", ...
};

struct PrepareOptions {
  double weld_distance =
      0;  ///< relative to the bounding box diagonal; 0 = identical positions only
};

/// Welds, fans, drops empty faces, makes orientation consistent, splits non-manifold vertices and
/// edges, keeps the component of largest area. kBadInput when no triangle with area is left, a
/// coordinate is not finite, or an index is out of range.
Result<PreparedMesh> prepare(const PolygonSoup& soup, const PrepareOptions& options = {});

/// A point of the mesh in the file's numbering: face is the file triangle, bary refers to its fan
/// order.
SurfacePoint to_file(const PreparedMesh& prepared, const SurfacePoint& p);

}  // namespace crosspatch
