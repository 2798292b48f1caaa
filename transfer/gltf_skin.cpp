#include "transfer/gltf_skin.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include "core/index.hpp"
#include "transfer/gltf_accessor.hpp"

namespace crosspatch {
namespace {

using Frame = Eigen::Matrix4d;

Status bad(std::string message) {
  return fail(ErrorCode::kBadInput, std::move(message));
}

/// What is wrong with a matrix that should be a frame, or "".
std::string frame_problem(const Frame& frame) {
  // Below it a unit of length has all but vanished in single precision.
  constexpr double kFlat = 1e-9;
  if (!frame.allFinite()) return "is not finite";
  const Eigen::Matrix3d linear = frame.topLeftCorner<3, 3>();
  const double volume = linear.determinant();
  const double box = linear.colwise().norm().prod();
  if (!(std::abs(volume) > kFlat * box) || !(box > 0) || !frame.inverse().allFinite())
    return "has no inverse";
  return volume < 0 ? "mirrors" : "";
}

class SkinReader {
 public:
  SkinReader(const tinygltf::Model& model,
             const std::vector<MeshInstance>& instances,
             const ReadLimits& limits)
      : model_(model), instances_(instances), limits_(limits) {}

  Result<ReadSkin> read() {
    joint_of_node_.assign(model_.nodes.size(), -1);
    for (const MeshInstance& instance : instances_)
      if (instance.skin >= 0 && skins_.insert(instance.skin).second)
        if (Status s = add_joints(instance); !s) return tl::unexpected(s.error());
    if (out_.skin.joints.empty()) return fail(ErrorCode::kBadInput, "no mesh of it has a skin");
    if (Status s = add_nodes(); !s) return tl::unexpected(s.error());
    if (Status s = place_nodes(); !s) return tl::unexpected(s.error());
    for (const MeshInstance& instance : instances_)
      if (Status s = add_weights(instance); !s) return tl::unexpected(s.error());
    out_.skin.weights.resize(static_cast<Eigen::Index>(vertices_),
                             static_cast<Eigen::Index>(joints_.size()));
    out_.skin.weights.setFromTriplets(weights_.begin(), weights_.end());
    return std::move(out_);
  }

 private:
  struct Joint {
    int file_node = 0;
    Frame bind;
  };

  Status add_joints(const MeshInstance& instance) {
    const tinygltf::Skin& skin = model_.skins[idx(instance.skin)];
    if (skin.joints.empty()) return bad(fmt::format("skin {}: has no joints", instance.skin));
    GltfValues matrices;
    if (skin.inverseBindMatrices >= 0) {
      auto read = read_accessor(model_, skin.inverseBindMatrices, limits_.max_vertices);
      if (!read) return tl::unexpected(read.error());
      matrices = std::move(*read);
      if (matrices.components != 16 || matrices.count() < skin.joints.size())
        return bad(fmt::format("skin {}: {} inverse bind matrices of {} numbers for {} joints",
                               instance.skin,
                               matrices.count(),
                               matrices.components,
                               skin.joints.size()));
    }
    std::vector<bool> seen(model_.nodes.size(), false);
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      const int node = skin.joints[j];
      const auto where = [&] { return fmt::format("skin {} joint {}", instance.skin, j); };
      if (seen[idx(node)]) return bad(fmt::format("{}: node {} comes twice", where(), node));
      seen[idx(node)] = true;
      Frame inverse = Frame::Identity();
      if (!matrices.values.empty()) inverse = Eigen::Map<const Frame>(&matrices.values[16 * j]);
      // Exporters leave rounding in the last row.
      constexpr double kAffine = 1e-3;
      const Eigen::RowVector4d last(0, 0, 0, 1);
      if (!inverse.row(3).allFinite() || !inverse.row(3).isApprox(last, kAffine))
        return bad(where() + ": the inverse bind matrix is not affine");
      inverse.row(3) = last;
      if (const std::string problem = frame_problem(inverse); !problem.empty())
        return bad(fmt::format("{}: the inverse bind matrix {}", where(), problem));
      Frame bind = to_first(instances_, instance) * inverse.inverse();
      bind.row(3) = last;
      if (const std::string problem = frame_problem(bind); !problem.empty())
        return bad(fmt::format("{}: the bind frame {}", where(), problem));
      if (Status s = add_joint(node, bind, where()); !s) return s;
    }
    return {};
  }

  Status add_joint(int node, const Frame& bind, const std::string& where) {
    int& joint = joint_of_node_[idx(node)];
    if (joint < 0) {
      joint = static_cast<int>(joints_.size());
      joints_.push_back({node, bind});
      out_.skin.joints.push_back(-1);
    } else if (!joints_[idx(joint)].bind.isApprox(bind, 1e-4)) {
      return bad(fmt::format("{}: another skin binds node {} elsewhere", where, node));
    }
    return {};
  }

  /// The joints and what is above them, parents first.
  Status add_nodes() {
    std::vector<int> parent(model_.nodes.size(), -1);
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      for (const int child : model_.nodes[n].children) {
        if (parent[idx(child)] >= 0) return bad(fmt::format("node {}: has two parents", child));
        parent[idx(child)] = static_cast<int>(n);
      }
    out_.skeleton_node.assign(model_.nodes.size(), -1);
    std::vector<int> chain;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      chain.clear();
      for (int n = joints_[j].file_node; n >= 0 && out_.skeleton_node[idx(n)] < 0;
           n = parent[idx(n)]) {
        if (chain.size() > model_.nodes.size())
          return bad(fmt::format("node {}: is its own ancestor", n));
        chain.push_back(n);
      }
      for (auto n = chain.rbegin(); n != chain.rend(); ++n) {
        out_.skeleton_node[idx(*n)] = static_cast<int>(out_.file_node.size());
        out_.file_node.push_back(*n);
        SkeletonNode node;
        node.name = model_.nodes[idx(*n)].name;
        if (parent[idx(*n)] >= 0) node.parent = out_.skeleton_node[idx(parent[idx(*n)])];
        out_.skin.nodes.push_back(std::move(node));
      }
      out_.skin.joints[j] = out_.skeleton_node[idx(joints_[j].file_node)];
    }
    return {};
  }

  /// Bind frames: those of joints are given; nodes below a joint stand where they rest to it, nodes
  /// above all joints where the first of them rests to them.
  Status place_nodes() {
    auto& nodes = out_.skin.nodes;
    std::vector<bool> placed(nodes.size(), false), above(nodes.size(), false);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const int joint = joint_of_node_[idx(out_.file_node[n])];
      const int parent = nodes[n].parent;
      above[n] = joint < 0 && (parent < 0 || above[idx(parent)]);
      if (joint >= 0)
        nodes[n].bind = joints_[idx(joint)].bind;
      else if (parent >= 0 && placed[idx(parent)])
        nodes[n].bind = nodes[idx(parent)].bind * rest(n);
      else
        continue;
      placed[n] = true;
    }
    for (std::size_t n = nodes.size(); n-- > 0;) {
      assert(placed[n] && "what is not below a joint has one below");
      const int parent = nodes[n].parent;
      if (parent < 0 || !above[idx(parent)]) continue;
      nodes[idx(parent)].bind = nodes[n].bind * rest(n).inverse();
      placed[idx(parent)] = true;
    }
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const int parent = nodes[n].parent;
      nodes[n].local =
          parent < 0 ? rest(n) : Frame(nodes[idx(parent)].bind.inverse() * nodes[n].bind);
      if (!rest(n).allFinite())
        return bad(fmt::format("node {}: transform is not finite", out_.file_node[n]));
      for (Frame* frame : {&nodes[n].bind, &nodes[n].local}) {
        frame->row(3) = Eigen::RowVector4d(0, 0, 0, 1);
        if (const std::string problem = frame_problem(*frame); !problem.empty())
          return bad(fmt::format("node {}: its bind frame {}", out_.file_node[n], problem));
      }
    }
    return {};
  }

  [[nodiscard]] Frame rest(std::size_t n) const {
    return local_transform(model_.nodes[idx(out_.file_node[n])]);
  }

  Status add_weights(const MeshInstance& instance) {
    for (const auto& primitive : model_.meshes[idx(instance.mesh)].primitives) {
      if (!has_triangles(primitive)) continue;
      const std::size_t count = model_.accessors[idx(primitive.attributes.at("POSITION"))].count;
      if (instance.skin >= 0)
        for (int set = 0;; ++set) {
          const auto joints = primitive.attributes.find(fmt::format("JOINTS_{}", set));
          const auto weights = primitive.attributes.find(fmt::format("WEIGHTS_{}", set));
          if (joints == primitive.attributes.end() && weights == primitive.attributes.end()) break;
          if (joints == primitive.attributes.end() || weights == primitive.attributes.end())
            return bad(fmt::format(
                "mesh {}: JOINTS_{} and WEIGHTS_{} must come together", instance.mesh, set, set));
          if (Status s = add_set(instance, joints->second, weights->second, count); !s)
            return fail(s.error().code,
                        fmt::format("mesh {}: {}", instance.mesh, s.error().message));
        }
      vertices_ += static_cast<std::int64_t>(count);
      if (vertices_ > limits_.max_vertices)
        return bad(fmt::format("more than {} vertices", limits_.max_vertices));
    }
    return {};
  }

  Status add_set(const MeshInstance& instance,
                 int joints_accessor,
                 int weights_accessor,
                 std::size_t count) {
    const auto joints = read_accessor(model_, joints_accessor, limits_.max_vertices);
    if (!joints) return tl::unexpected(joints.error());
    const auto weights = read_accessor(model_, weights_accessor, limits_.max_vertices);
    if (!weights) return tl::unexpected(weights.error());
    for (const GltfValues* values : {&*joints, &*weights})
      if (values->components != 4 || values->count() != count)
        return bad(fmt::format("joints or weights have {} elements of {} for {} vertices",
                               values->count(),
                               values->components,
                               count));
    const std::vector<int>& of_skin = model_.skins[idx(instance.skin)].joints;
    for (std::size_t i = 0; i < weights->values.size(); ++i) {
      const double weight = weights->values[i], joint = joints->values[i];
      if (!std::isfinite(weight) || weight < 0)
        return bad(fmt::format("vertex {} has weight {}", i / 4, weight));
      if (weight == 0) continue;
      if (!(joint >= 0 && joint < static_cast<double>(of_skin.size())) ||
          joint != std::floor(joint))
        return bad(
            fmt::format("vertex {}: joint {} is outside [0, {})", i / 4, joint, of_skin.size()));
      const int node = of_skin[static_cast<std::size_t>(joint)];
      weights_.emplace_back(static_cast<int>(vertices_ + static_cast<std::int64_t>(i / 4)),
                            joint_of_node_[idx(node)],
                            weight);
    }
    return {};
  }

  const tinygltf::Model& model_;
  const std::vector<MeshInstance>& instances_;
  const ReadLimits& limits_;
  std::set<int> skins_;
  std::vector<Joint> joints_;
  std::vector<int> joint_of_node_;  ///< per node of the file
  std::vector<Eigen::Triplet<double>> weights_;
  std::int64_t vertices_ = 0;
  ReadSkin out_;
};

}  // namespace

Result<ReadSkin> read_skin(const tinygltf::Model& model,
                           const std::vector<MeshInstance>& instances,
                           const ReadLimits& limits) {
  return SkinReader(model, instances, limits).read();
}

}  // namespace crosspatch
