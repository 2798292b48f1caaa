#pragma once

#include <vector>

#include "param/surface_map.hpp"

namespace crosspatch {

/// The part of a straight segment of the source that one piece of the map takes to the target.
struct ImageChord {
  double begin = 0, end = 1;  ///< along the segment
  SurfacePoint from, to;      ///< on the target, in one face
};

/// A map taken apart into triangles on which it is linear, the fans of the overlay's polygons, so
/// that any point or segment of the source can be carried.
class MapPieces {
 public:
  /// `source` must outlive the pieces.
  MapPieces(const SurfaceMap& map, const TriangleMesh& source, const TriangleMesh& target);

  /// Where a point of the source lies on the target; no point where it is not mapped. Weights below
  /// a billionth become zero, so that points on edges say so.
  [[nodiscard]] SurfacePoint image(const SurfacePoint& p) const;

  /// The image of the segment between two points (barycentric) of a source face, in its order;
  /// where chords leave a gap the source is not mapped.
  [[nodiscard]] std::vector<ImageChord> image(int face,
                                              const Vector3d& from,
                                              const Vector3d& to) const;

 private:
  struct Piece {
    Eigen::Matrix3d weights;  ///< from the source face's barycentric coordinates to the corners'
    Eigen::Matrix3d corners;  ///< barycentric in the target face, a column a corner
    int target_face;
  };
  [[nodiscard]] SurfacePoint image_in_face(const SurfacePoint& p) const;

  const TriangleMesh& source_;
  std::vector<int> begin_;  ///< per source face: its first piece
  std::vector<Piece> pieces_;
};

}  // namespace crosspatch
