#pragma once

#include <string_view>
#include <vector>

#include "core/prepare.hpp"

namespace crosspatch {

/// Reads a map of points that any program wrote: a line a vertex of the source's file with either
/// one number, a vertex of the target's file, or four, `face b0 b1 b2`, a point of one of its
/// triangles. Vertices and triangles are counted from `base`, 0 or 1; -1 or nan means unmapped
/// (any numbers behind it in the form of four). Blank lines and what follows a `#` are passed over.
///
/// Returns a point of the target's mesh for each vertex of the source's mesh: where vertices of the
/// file were welded, that of the first which has one; none for images in parts that are left out.
/// kBadInput with the line's number: another form or a mixture of both, an index out of range,
/// weights that are negative or do not sum to 1; a number of lines other than the vertices.
Result<std::vector<SurfacePoint>> parse_point_map(std::string_view text,
                                                  int base,
                                                  const PreparedMesh& source,
                                                  const PreparedMesh& target);

}  // namespace crosspatch
