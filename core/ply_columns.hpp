#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/ply_header.hpp"

namespace crosspatch {

/// A property that every vertex of a PLY file has.
struct PlyColumn {
  std::string name;
  PlyType type = PlyType::kFloat64;
  std::vector<double> values;  ///< one a vertex, in the file's order; NaN where the file says so
};

/// The vertices of a PLY file without what makes the mesh and its look: places, normals, texture
/// coordinates, colours and lists are left out.
struct PlyVertexColumns {
  long long vertex_count = 0;
  std::vector<PlyColumn> columns;
};

/// Reads the columns of a PLY file's element `vertex`. kBadInput: a broken header or body, no such
/// element, an infinite value.
Result<PlyVertexColumns> read_ply_columns(std::string_view bytes);

}  // namespace crosspatch
