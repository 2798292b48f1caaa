#pragma once

#include <string>
#include <vector>

#include "param/surface_map.hpp"
#include "transfer/source_attributes.hpp"

namespace crosspatch {

/// How a field's values change on their way.
enum class FieldKind {
  kNumber,   ///< interpolated
  kTangent,  ///< a vector that lies in the surface
  kLabel,    ///< a whole number that is never mixed with another; kNoLabel where there is none
};

constexpr double kNoLabel = -1;

/// Numbers at the vertices of a mesh file.
///
/// Invariants: (1) `values` has a row a vertex of the file and a column a name; (2) kTangent has
/// three columns, x, y and z, the other kinds one; (3) labels are whole and fit 32 bits; other
/// values are finite, or NaN where the vertex has none.
struct VertexField {
  FieldKind kind = FieldKind::kNumber;
  std::vector<std::string> columns;
  Eigen::MatrixXd values;
};

struct CarriedFields {
  std::vector<VertexField> fields;  ///< at the vertices of the target's file
  int unmapped_vertices = 0;        ///< of the target's file: nothing is carried there
};

/// Carries fields of the source's file to the vertices of the target's file: each takes what stands
/// at its place on the source under the exact map.
///
/// Numbers are interpolated in the source triangle; labels are those of its corner with the
/// largest weight (of equals, of the file's first vertex). A tangent vector at a vertex is turned
/// with the surface's normal into each triangle, interpolated there, pushed forward by the
/// differential of the map's pieces around the target vertex, and their mean, weighted by the
/// pieces' angles, is turned into the plane of the vertex; what is not tangent is left out. A field
/// without a value at a corner that counts has none (NaN). Where vertices of a file were welded,
/// each triangle keeps the values of its own.
CarriedFields carry_fields(const AttributedMesh& source,
                           const AttributedMesh& target,
                           const SurfaceMap& map,
                           const std::vector<VertexField>& fields);

}  // namespace crosspatch
