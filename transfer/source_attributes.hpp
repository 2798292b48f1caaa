#pragma once

#include <vector>

#include "core/prepare.hpp"
#include "core/surface_point.hpp"

namespace crosspatch {

/// A prepared mesh beside the soup that holds its attributes; both must outlive the view.
struct AttributedMesh {
  const PreparedMesh& prepared;
  const PolygonSoup& soup;
};

/// Everything that is carried over, flattened to `width` numbers a face corner: first every UV set
/// (u, v), then linear RGBA if the soup has colours.
///
/// Invariants: (1) values has 3 #F width finite entries, corner-major; (2) material has one entry a
/// face, in [-1, #materials); usable[f] is false where the face lacks UVs that its material's
/// textures need; (3) continuous[h] says that the values and the material agree on both sides of
/// half-edge h, and is symmetric under twin.
struct SourceAttributes {
  int uv_sets = 0;
  bool colors = false;
  int width = 0;
  std::vector<double> values;
  std::vector<int> material;
  std::vector<bool> usable;
  std::vector<bool> continuous;
  /// Texels per unit of u and v, material-major, entry (material + 1) * uv_sets + set.
  std::vector<Vector2d> texels;
};

/// Gathers the attributes of `source` per face corner. `default_texels` stands in for the image
/// size of UV sets that no readable texture uses.
SourceAttributes source_attributes(const AttributedMesh& source, int default_texels);

/// Writes the `width` values at `p` (barycentric in its face) to `out`.
void evaluate(const SourceAttributes& attributes, const SurfacePoint& p, double* out);

/// How far two attribute vectors of one material are apart.
struct AttributeError {
  double uv_texels = 0;  ///< largest over the UV sets, Euclidean
  double color = 0;      ///< largest over the channels
};
AttributeError difference(const SourceAttributes& attributes,
                          int material,
                          const double* a,
                          const double* b);

}  // namespace crosspatch
