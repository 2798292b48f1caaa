#pragma once

#include <array>
#include <vector>

#include "transfer/bake.hpp"
#include "transfer/unwrap.hpp"

namespace crosspatch {

/// The overlay, with the places of its triangles in the image.
struct Carried {
  int size = 0;       ///< of the image, texels a side
  TexturedMesh mesh;  ///< without places and normals if no material has a normal map
  std::vector<std::array<Vector2d, 3>> texels;  ///< per triangle
  std::vector<Vector3d> target_bary;  ///< per corner, in its target face; for normal maps only
};

/// The overlay of the map over the unwrap. Fills in of the statistics the overlay's size, coverage
/// and density ratio; what only they need is gone when it returns.
Carried carry(const AttributedMesh& source,
              const AttributedMesh& target,
              const SurfaceMap& map,
              const Unwrap& unwrap,
              int size,
              BakeStatistics& s);

}  // namespace crosspatch
