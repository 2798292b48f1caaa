#pragma once

#include <vector>

#include "core/surface_point.hpp"
#include "tools/raster.hpp"

namespace crosspatch {

/// How corresponding places of two surfaces are marked.
enum class PairPattern {
  kPosition,  ///< by the colour of their place in the target's box
  kChecker,   ///< the same, darkened in every other cube of a grid
};

/// Where each source vertex lies on the target (#source vertices x 3); NaN where unmapped.
/// `map` speaks of the rows of `target_F`.
MatrixX3d image_positions(const std::vector<SurfacePoint>& map,
                          const MatrixX3d& target_V,
                          const MatrixX3i& target_F);

/// Colours `surface` by `places` (#V x 3), one place on the target a vertex, in the box around
/// `target_V`. The target with its own vertices and the source with its image positions then show
/// corresponding places alike. Faces with an unmapped corner stay grey.
void color_by_place(Surface& surface,
                    const MatrixX3d& places,
                    const MatrixX3d& target_V,
                    PairPattern pattern);

/// Both surfaces in one scene: the second turned, scaled to the diagonal of the first and moved
/// along `right` (a unit vector) until it stands clear of it.
struct PlacedPair {
  Scene scene;
  double scale = 1;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();

  /// Where a point of the second is drawn.
  [[nodiscard]] Vector3d placed(const Vector3d& p) const { return scale * (turn * p) + shift; }
};
PlacedPair place_beside(const Scene& first,
                        Scene second,
                        const Eigen::Matrix3d& turn,
                        const Vector3d& right);

/// A thin line from each row of `first` to the same row of `second` in a colour of its own.
void add_correspondences(Scene& scene,
                         const MatrixX3d& first,
                         const MatrixX3d& second,
                         double radius);

}  // namespace crosspatch
