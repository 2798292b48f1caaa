#pragma once

#include <vector>

#include "core/file_bytes.hpp"
#include "transfer/gltf_nodes.hpp"
#include "transfer/motion.hpp"

namespace crosspatch {

struct ReadSkin {
  Skin skin;
  std::vector<int> file_node;      ///< per node of the skeleton
  std::vector<int> skeleton_node;  ///< per node of the file, -1 if it is not of the skeleton
};

/// The skins of the shown meshes as one, vertices numbered as read_gltf does, frames in the
/// coordinates of the first mesh; all sets of weights. The skeleton has the joints and all nodes
/// above them. Nodes above all joints stand where the topmost joint's place at rest puts them.
///
/// kBadInput: no skin; a skin without joints, with a joint twice, or with too few matrices; a frame
/// that is not finite, not affine, mirrors or has no inverse; two skins that bind one joint in two
/// ways; a node with two parents or above itself; joint indices out of range, weights that are
/// negative or not finite, sets of another length than the places.
Result<ReadSkin> read_skin(const tinygltf::Model& model,
                           const std::vector<MeshInstance>& instances,
                           const ReadLimits& limits);

}  // namespace crosspatch
