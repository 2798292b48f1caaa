#pragma once

#include "param/parametrize.hpp"
#include "param/patch_disc.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// Corresponding patches of two surfaces, flattened onto one rectangle about the origin.
///
/// Invariants: (1) both discs have the same sides and shares, hence bit-equal boundary positions;
/// (2) every triangle of both is counter-clockwise in the rectangle.
struct PatchPair {
  PatchDisc source, target;
  Vector2d size{1, 1};  ///< of the rectangle: powers of two
  PatchParametrization source_chart, target_chart;
};

struct PatchOptions {
  ParametrizeOptions parametrize;  ///< the boundary stays fixed: neighbours share it
  /// Longest side of a rectangle over its shortest; longer patches are squeezed.
  double largest_aspect = 8;
};

/// Cuts both drawings of one layout into patches and flattens each pair onto the same rectangle,
/// arcs by arc length. Pairs are independent and run in parallel; the result does not depend on the
/// number of threads. kBadInput if the layouts differ; errors of the discs and of parametrize name
/// the patch.
Result<std::vector<PatchPair>> parametrize_patches(const DrawnLayout& source,
                                                   const DrawnLayout& target,
                                                   const PatchOptions& options = {});

/// The map that takes each patch to its partner through their rectangle, between the drawn meshes.
/// Bijective, and continuous across arcs. kNumerical if two charts cannot be brought into general
/// position.
Result<SurfaceMap> patchwise_map(const DrawnLayout& source,
                                 const DrawnLayout& target,
                                 const std::vector<PatchPair>& patches);

/// A map between drawn meshes as a map between the meshes that the layouts were drawn on.
SurfaceMap on_given_meshes(const SurfaceMap& map,
                           const DrawnLayout& source,
                           const TriangleMesh& given_source,
                           const DrawnLayout& target,
                           const TriangleMesh& given_target);

}  // namespace crosspatch
