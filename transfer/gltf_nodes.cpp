#include "transfer/gltf_nodes.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <Eigen/LU>
#include <numeric>

namespace crosspatch {
namespace {

/// Nodes where the walk begins.
std::vector<int> roots(const tinygltf::Model& model) {
  if (!model.scenes.empty()) {
    const int scene = model.defaultScene >= 0 ? model.defaultScene : 0;
    return model.scenes[static_cast<std::size_t>(scene)].nodes;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes)
    for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
  std::vector<int> out;
  for (std::size_t i = 0; i < is_child.size(); ++i)
    if (!is_child[i]) out.push_back(static_cast<int>(i));
  return out;
}

}  // namespace

Eigen::Matrix4d local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (node.translation.size() == 3) transform.translate(Vector3d(node.translation.data()));
  if (node.rotation.size() == 4) {
    const Eigen::Quaterniond q(
        node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    transform.rotate(q.norm() > 0 ? q.normalized() : Eigen::Quaterniond::Identity());
  }
  if (node.scale.size() == 3) transform.scale(Vector3d(node.scale.data()));
  return transform.matrix();
}

bool has_triangles(const tinygltf::Primitive& primitive) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  return mode >= TINYGLTF_MODE_TRIANGLES && mode <= TINYGLTF_MODE_TRIANGLE_FAN &&
         primitive.attributes.count("POSITION") > 0;
}

Result<std::vector<MeshInstance>> mesh_instances(const tinygltf::Model& model) {
  std::vector<Eigen::Matrix4d> world(model.nodes.size(), Eigen::Matrix4d::Identity());
  std::vector<bool> seen(model.nodes.size(), false);
  std::vector<int> stack;
  const auto visit = [&](int n, const Eigen::Matrix4d& parent) -> Status {
    const std::size_t i = static_cast<std::size_t>(n);
    if (seen[i])
      return fail(ErrorCode::kBadInput,
                  fmt::format("node {}: has two parents or is its own ancestor", n));
    seen[i] = true;
    world[i] = parent * local_transform(model.nodes[i]);
    if (!world[i].allFinite())
      return fail(ErrorCode::kBadInput, fmt::format("node {}: transform is not finite", n));
    stack.push_back(n);
    return {};
  };
  for (const int n : roots(model))
    if (Status s = visit(n, Eigen::Matrix4d::Identity()); !s) return tl::unexpected(s.error());
  while (!stack.empty()) {
    const std::size_t i = static_cast<std::size_t>(stack.back());
    stack.pop_back();
    for (const int child : model.nodes[i].children)
      if (Status s = visit(child, world[i]); !s) return tl::unexpected(s.error());
  }
  std::vector<MeshInstance> out;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const tinygltf::Node& node = model.nodes[i];
    if (!seen[i] || node.mesh < 0) continue;
    // glTF 2.0, section 3.7.3.3: a skinned mesh ignores the transform of its node.
    out.push_back({static_cast<int>(i),
                   node.mesh,
                   node.skin,
                   node.skin >= 0 ? Eigen::Matrix4d::Identity() : world[i]});
  }
  return out;
}

Eigen::Matrix4d to_first(const std::vector<MeshInstance>& instances, const MeshInstance& instance) {
  const Eigen::Matrix4d& first = instances.front().world;
  const Eigen::Matrix4d inverse = first.inverse();
  // Without a detour over the inverse, places keep their last digit.
  if (instance.world == first && inverse.allFinite()) return Eigen::Matrix4d::Identity();
  return inverse * instance.world;
}

}  // namespace crosspatch
