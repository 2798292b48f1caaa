#pragma once

#include "core/cut_handles.hpp"
#include "core/fill_holes.hpp"

namespace crosspatch {

/// A connected part of what closes a capped surface.
struct Cap {
  std::vector<int> faces;  ///< of CappedSurface::filled
  std::vector<int> rim;  ///< vertices of CappedSurface::cut, surface on the left, cap on the right
  int handle = -1;       ///< the cut that it closes one bank of, or -1: a hole of the surface
};

/// A connected surface made a sphere: handles cut, then all boundary loops closed. Faces keep their
/// numbers through both.
struct CappedSurface {
  CutMesh cut;
  FilledMesh filled;
  std::vector<Cap> caps;
  int holes = 0;  ///< boundary loops of the given surface

  [[nodiscard]] bool is_sphere() const { return caps.empty(); }
};

/// Errors of cut_handles and fill_holes.
Result<CappedSurface> cap_surface(const TriangleMesh& mesh);

}  // namespace crosspatch
