#pragma once

#include <vector>

#include "core/result.hpp"
#include "core/types.hpp"

namespace tinygltf {
class Model;
}

namespace crosspatch {

/// One use of a mesh by a node.
struct MeshInstance {
  int mesh = 0;
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();  ///< mesh to scene; identity under a skin
  bool skinned = false;
};

/// The meshes that the default scene shows (the first scene if none is named, every root node if
/// there is no scene), in the order of the file's nodes. kBadInput: a node with two parents or in
/// a cycle, a transform that is not finite.
Result<std::vector<MeshInstance>> mesh_instances(const tinygltf::Model& model);

}  // namespace crosspatch
