#pragma once

#include "param/surface_map.hpp"
#include "transfer/motion.hpp"
#include "transfer/source_attributes.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

struct CarriedMotion {
  Motion motion;  ///< of the positions of the mesh it was made for
  /// Positions without a counterpart, or with one that follows no joint: they go with the nearest
  /// along edges that has one.
  int unmapped_positions = 0;
  double dropped_weight = 0;   ///< largest sum of weights beyond the four largest
  int joints_with_parent = 0;  ///< joints that no part of the surface turns about
};

/// Carries how `source` moves over the map to `mesh`, which was made of `target` and names a point
/// of the map at each position. `motion` is that of the vertices of the source's file.
///
/// Weights are interpolated in the source triangle; the four largest are kept.
/// Places of joints: each goes with the surface around it, by the similarity that fits the images
/// best of the places where the surface passes from the joint's part (it and all below it) to the
/// rest. Frames of the carried skeleton are parallel to the target's axes, so that the bind pose
/// moves no vertex by a bit; a joint's motion relative to its parent is that of the source, turned
/// and scaled by the similarity: what bends a knee there bends it about the knee's axis here.
/// Uneven scales in tracks become their mean. Displacements of morph targets are interpolated and
/// then turned and scaled by the similarity nearest to the differential of the map (area keeps its
/// ratio, normal goes to normal), averaged over some edges; displaced normals are turned only.
/// Precondition: `motion` is valid. kInternal when it does not belong to the source's file.
Result<CarriedMotion> carry_motion(const Motion& motion,
                                   const AttributedMesh& source,
                                   const AttributedMesh& target,
                                   const SurfaceMap& map,
                                   const TexturedMesh& mesh);

}  // namespace crosspatch
