#pragma once

#include <vector>

#include "core/fill_holes.hpp"
#include "core/surface_point.hpp"

namespace crosspatch {

/// An exact piecewise map between two surfaces: their common subdivision (overlay).
///
/// A point of the overlay lies on both surfaces; a polygon of it lies inside one face of each, is
/// convex there and runs counter-clockwise; polygons meet edge to edge. Where the map is a
/// bijection, the polygons fill every face of both meshes.
///
/// Invariants: (1) source.size() == target.size() == number of points; (2) the corners of polygon p
/// are corner[polygon_begin[p] .. polygon_begin[p + 1]), at least three, and each lies in the
/// closed faces source_face[p] and target_face[p]; (3) point_of_source_vertex /
/// point_of_target_vertex give the overlay's point at a mesh vertex, or -1 where the vertex is
/// unmapped.
struct SurfaceMap {
  std::vector<SurfacePoint> source;  ///< per point; `face` is any face that holds it
  std::vector<SurfacePoint> target;
  std::vector<int> polygon_begin{0};
  std::vector<int> corner;
  std::vector<int> source_face;  ///< per polygon
  std::vector<int> target_face;
  std::vector<int> point_of_source_vertex;
  std::vector<int> point_of_target_vertex;

  [[nodiscard]] int point_count() const { return static_cast<int>(source.size()); }
  [[nodiscard]] int polygon_count() const { return static_cast<int>(source_face.size()); }
};

/// Checks the invariants of SurfaceMap, and that it is a bijection: every side is used once in each
/// direction or lies on a boundary of both meshes, and the overlay has the Euler characteristic of
/// both.
Status validate(const SurfaceMap& map, const TriangleMesh& source, const TriangleMesh& target);

/// The same for a map of parts: what it covers it covers once, and where it ends the source or the
/// target ends too.
Status validate_partial(const SurfaceMap& map,
                        const TriangleMesh& source,
                        const TriangleMesh& target);

/// The part of a map between closed surfaces that joins the open surfaces they were made from:
/// polygons on a cap of either are left out, and with them the vertices whose images lie there
/// (-1).
SurfaceMap without_caps(const SurfaceMap& map, const FilledMesh& source, const FilledMesh& target);

/// `p`, given in any face, with barycentric coordinates of `face`, which must hold it too (up to
/// rounding: weight on a corner outside `face` is dropped and the rest rescaled).
SurfacePoint in_face(const TriangleMesh& mesh, const SurfacePoint& p, int face);

/// The faces that hold `p`: one, the two at an edge, or all around a vertex; weights that are
/// exactly zero decide.
std::vector<int> faces_at(const TriangleMesh& mesh, const SurfacePoint& p);

/// The identity of a mesh with itself.
SurfaceMap identity_map(const TriangleMesh& mesh);

/// The same map read from target to source.
SurfaceMap inverse(const SurfaceMap& map);

}  // namespace crosspatch
