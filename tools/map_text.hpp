#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/prepare.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// Where each vertex of the source's file lies on the target, in the numbering of the target's
/// file; no point for vertices that are left out or unmapped.
std::vector<SurfacePoint> map_of_file_vertices(const SurfaceMap& map,
                                               const PreparedMesh& source,
                                               const PreparedMesh& target);

/// One line a point: `face b0 b1 b2`, numbers that read back equal; `-1 0 0 0` without a point.
std::string map_text(const std::vector<SurfacePoint>& points);

/// Reads what map_text writes: at most `triangle_count` triangles are known; blank lines and what
/// follows a `#` are passed over. kBadInput with the line's number for anything else, for
/// coordinates that do not sum to 1 and for a number of lines other than `point_count`.
Result<std::vector<SurfacePoint>> parse_map(std::string_view text,
                                            int point_count,
                                            int triangle_count);

/// Appends "face b0 b1 b2", numbers that read back equal, or "-1 0 0 0".
void append_point(std::string& text, const SurfacePoint& p);

}  // namespace crosspatch
