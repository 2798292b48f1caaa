#pragma once

#include <cstdint>
#include <vector>

#include "param/surface_map.hpp"
#include "transfer/source_attributes.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

inline constexpr std::uint8_t kNoPatch = 255;

/// A surface as a page draws it, with what is known at the corners of its triangles.
///
/// Invariants: `corner` and `place` have one entry a corner of `mesh`, 3 a triangle; `patch` has
/// one a triangle.
struct DisplayMesh {
  TexturedMesh mesh;
  std::vector<SurfacePoint> corner;  ///< on the prepared mesh
  std::vector<Vector3d> place;      ///< in the source's coordinates: itself, or where it comes from
  std::vector<std::uint8_t> patch;  ///< per triangle of `mesh`; kNoPatch where nothing is mapped
};

/// The surface with its own texture; places are its own. `patch`: below kNoPatch, per face of the
/// prepared mesh.
Result<DisplayMesh> display_source(const AttributedMesh& source,
                                   const std::vector<std::uint8_t>& patch);

/// The target with the source's texture, cut along its seams, along the borders of the source's
/// patches (of a polygon's faces the first one's counts) and wherever places, linear on each
/// triangle, would stray by more than `tolerance` (in the source's largest extent) from the map.
/// Corners without a map have NaN places.
Result<DisplayMesh> display_target(const AttributedMesh& source,
                                   const AttributedMesh& target,
                                   const std::vector<std::uint8_t>& patch,
                                   const SurfaceMap& map,
                                   double tolerance);

}  // namespace crosspatch
