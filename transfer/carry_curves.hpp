#pragma once

#include <string>
#include <vector>

#include "param/surface_map.hpp"

namespace crosspatch {

/// A named point of a surface.
struct MarkedPoint {
  std::string name;
  SurfacePoint point;  ///< no point: it lies where nothing is mapped
};

/// A named chain of points of a surface.
struct SurfaceCurve {
  std::string name;
  bool closed = false;  ///< the last point is joined to the first, which is not repeated
  std::vector<SurfacePoint> points;
};

/// What is drawn on a surface.
struct Drawing {
  std::vector<MarkedPoint> landmarks;
  std::vector<SurfaceCurve> curves;
};

struct CarriedDrawing {
  Drawing drawing;
  int unmapped_landmarks = 0;  ///< they have no point
  int gaps = 0;                ///< where curves were cut because nothing is mapped there
  int paths = 0;               ///< parts of curves between points that share no triangle
};

/// Carries landmarks and curves of the source through the exact map.
///
/// Points of a curve that share a triangle are joined straight, others by a short path over the
/// surface (SurfacePaths). The image of a curve has a point wherever it crosses an edge of either
/// mesh, so that it is straight in between, and consecutive points share a triangle of the target.
/// A curve that runs over places that are not mapped is carried in parts, open curves of its name;
/// a point without a place counts as such.
CarriedDrawing carry_drawing(const Drawing& drawing,
                             const TriangleMesh& source,
                             const TriangleMesh& target,
                             const SurfaceMap& map);

}  // namespace crosspatch
