#pragma once

#include "transfer/carry_motion.hpp"
#include "transfer/fit_similarity.hpp"

namespace crosspatch {

/// Per node of the skeleton, how its surroundings come to lie on the target. Nodes that no part of
/// the surface turns about have that of their parent, those of the whole surface that of the whole.
struct SkeletonFit {
  std::vector<Similarity> nodes;
  int with_parent = 0;  ///< joints that go with their parent
};

SkeletonFit fit_skeleton(const Skin& skin,
                         const AttributedMesh& source,
                         const AttributedMesh& target,
                         const SurfaceMap& map);

/// The nodes in the target: frames that are not turned, at places whose differences are exact in
/// single precision.
std::vector<SkeletonNode> carried_nodes(const std::vector<SkeletonNode>& nodes,
                                        const SkeletonFit& fit);

/// What moves the nodes of `from` the same way moves those of `to`.
std::vector<Track> carried_tracks(const std::vector<Track>& tracks,
                                  const std::vector<SkeletonNode>& from,
                                  const std::vector<SkeletonNode>& to,
                                  const SkeletonFit& fit);

}  // namespace crosspatch
