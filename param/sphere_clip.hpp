#pragma once

#include <array>
#include <vector>

#include "param/surface_map.hpp"

namespace crosspatch {

/// The source as a sphere.
struct SphereSource {
  TriangleMesh mesh;     ///< without handles and holes; caps come behind the source's faces
  int face_count = 0;    ///< without caps
  int vertex_count = 0;  ///< ditto
  /// #V x 3: the embedding, every face positively oriented as seen from the middle; rows may have
  /// any length, which says how points are spread along great circles.
  MatrixX3d X;
};

/// A line across the target triangle: one of its sides (0, 1, 2), or a source edge.
struct ClipLine {
  int side = -1;
  int a = -1, b = -1;  ///< ends of the source edge, a < b
  bool operator==(const ClipLine&) const = default;
};

/// A corner of a clipped polygon: where two lines meet.
struct ClipCorner {
  Vector3d bary;    ///< in the target triangle, sums to 1
  int vertex = -1;  ///< of the triangle, 0 to 2
  int side = -1;    ///< of the triangle, where it lies on one between its ends
  ClipLine line;    ///< the source edge that crosses there
  int source_vertex = -1;
};

/// A clipped polygon; side i, on `lines[i]`, runs from corner i to the next.
struct ClippedFace {
  int face = -1;
  std::vector<ClipCorner> corners;
  std::vector<ClipLine> lines;
};

/// Share of a face that the triangle takes whose corners have these barycentric coordinates.
inline double signed_share(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return a.dot(b.cross(c));
}

/// Share of the target triangle that the polygon takes.
double area_share(const ClippedFace& polygon);

/// Where a point of the source lies in the space of its embedding.
Vector3d on_sphere(const SphereSource& source, const SurfacePoint& p);

/// The polygons by which source faces fill a triangle of the target whose corners go back to
/// `points` and whose sides to great circles; nothing where they do not fill it. `vertices` are the
/// target's, different for all corners: sides that two triangles share are cut alike.
std::vector<ClippedFace> clip_to_source(const SphereSource& source,
                                        const std::array<SurfacePoint, 3>& points,
                                        const std::array<int, 3>& vertices);

}  // namespace crosspatch
