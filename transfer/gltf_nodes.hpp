#pragma once

#include <vector>

#include "core/result.hpp"
#include "core/types.hpp"

namespace tinygltf {
class Model;
class Node;
struct Primitive;
}  // namespace tinygltf

namespace crosspatch {

/// One use of a mesh by a node.
struct MeshInstance {
  int node = 0;
  int mesh = 0;
  int skin = -1;                                        ///< or none
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();  ///< mesh to scene; identity under a skin
};

/// The node's matrix, or the product of its translation, rotation and scale.
Eigen::Matrix4d local_transform(const tinygltf::Node& node);

/// Whether the primitive is one of triangles with places.
bool has_triangles(const tinygltf::Primitive& primitive);

/// The meshes that the default scene shows (the first scene if none is named, every root node if
/// there is no scene), in the order of the file's nodes. kBadInput: a node with two parents or in
/// a cycle, a transform that is not finite.
Result<std::vector<MeshInstance>> mesh_instances(const tinygltf::Model& model);

/// The transform from an instance's coordinates to those of the first; NaN if the first has no
/// inverse.
Eigen::Matrix4d to_first(const std::vector<MeshInstance>& instances, const MeshInstance& instance);

}  // namespace crosspatch
