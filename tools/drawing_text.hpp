#pragma once

#include <string>
#include <string_view>

#include "core/prepare.hpp"
#include "transfer/carry_curves.hpp"

namespace crosspatch {

/// Reads landmarks and curves of a mesh file:
///     {"landmarks": [{"name": "nose", "point": P}, ...],
///      "curves": [{"name": "belt", "closed": true, "points": [P, P, ...]}, ...]}
/// A point P is a vertex of the file, a number, or [face, b0, b1, b2]; null is no point. Names and
/// "closed" may be missing; other keys are passed over. Points in parts of the file that are no
/// part of the mesh become no points. kBadInput, with the entry: another form, an index out of
/// range, weights that are negative or do not sum to 1, a curve of fewer than two points (closed:
/// three), nothing drawn at all.
Result<Drawing> parse_drawing(std::string_view text, const PreparedMesh& mesh);

/// What parse_drawing reads, each point as [face, b0, b1, b2] of the file, with its "position" in
/// the file's coordinates beside it ("positions" and "length" for curves).
std::string drawing_json(const Drawing& drawing, const PreparedMesh& mesh);

/// The same as ASCII PLY: a vertex a point, with the number of its curve as property `curve` (-1
/// for landmarks), and the pieces of curves as edges. Landmarks without a point are left out.
std::string drawing_ply(const Drawing& drawing, const PreparedMesh& mesh);

}  // namespace crosspatch
