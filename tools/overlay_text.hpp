#pragma once

#include <string>
#include <string_view>

#include "core/prepare.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// The map as a common subdivision in both files' numberings:
///     crosspatch-overlay 1
///     #points #polygons
///     fa a0 a1 a2 fb b0 b1 b2      a line a point: on source triangle fa, on target triangle fb
///     n p0 ... p(n-1) fa fb        a line a polygon inside source triangle fa, target triangle fb
std::string overlay_text(const SurfaceMap& map,
                         const PreparedMesh& source,
                         const PreparedMesh& target);

/// Whether a text begins as overlay_text does.
bool is_overlay_text(std::string_view text);

/// Reads what overlay_text writes, for the same two files. kBadInput with the line's number: not
/// of this form, an index out of range, a triangle that is no part of the mesh.
Result<SurfaceMap> parse_overlay(std::string_view text,
                                 const PreparedMesh& source,
                                 const PreparedMesh& target);

}  // namespace crosspatch
