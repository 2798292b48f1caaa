#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/soup.hpp"
#include "transfer/vertex_fields.hpp"

namespace crosspatch {

/// Reads fields from a CSV: a header with a name a column, then a row a vertex, in the file's
/// order.
///
/// The name tells the kind: `label:NAME` holds whole numbers, `tangent:NAME.x`, `tangent:NAME.y`
/// and `tangent:NAME.z` (or `_x`, `_y`, `_z`) are the components of a vector in the surface, any
/// other column numbers. An empty cell means no value. Cells may stand in double quotes. kBadInput
/// with the line: another number of cells, no number, a label that is not whole or does not fit 32
/// bits, an infinite value; a name missing, twice, or without its other components; a number of
/// rows other than `vertices`.
Result<std::vector<VertexField>> parse_fields_csv(std::string_view text, int vertices);

/// Reads fields from the vertices of a PLY, see read_ply_columns. Kinds are told as in a CSV;
/// columns of an integer type are labels. kBadInput: no field, another number of vertices.
Result<std::vector<VertexField>> parse_fields_ply(std::string_view bytes, int vertices);

/// What parse_fields_csv reads; numbers read back equal, no value is an empty cell.
std::string fields_csv(const std::vector<VertexField>& fields);

/// The mesh of a file, vertices and polygons in its order, with the fields as properties of its
/// vertices, as ASCII PLY; no value is nan. Blanks in names become underscores.
std::string fields_ply(const std::vector<VertexField>& fields, const PolygonSoup& mesh);

}  // namespace crosspatch
