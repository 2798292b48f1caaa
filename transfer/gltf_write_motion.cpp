#include "transfer/gltf_write_motion.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <limits>
#include <map>

#include "core/index.hpp"
#include "transfer/gltf_buffer.hpp"

namespace crosspatch {
namespace {

template <class T>
int add_joints(tinygltf::Model& model,
               const Skin& skin,
               const std::vector<int>& rows,
               int component) {
  std::vector<std::array<T, 4>> joints;
  for (const int row : rows) {
    joints.push_back({0, 0, 0, 0});
    std::size_t k = 0;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, row); w; ++w)
      joints.back()[k++] = static_cast<T>(w.col());
  }
  return add_attribute(model, joints, component, TINYGLTF_TYPE_VEC4);
}

int add_weights(tinygltf::Model& model, const Skin& skin, const std::vector<int>& rows) {
  std::vector<std::array<float, 4>> weights;
  for (const int row : rows) {
    weights.push_back({0, 0, 0, 0});
    std::size_t k = 0;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, row); w; ++w)
      weights.back()[k++] = static_cast<float>(w.value());
  }
  return add_attribute(model, weights, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4);
}

std::vector<std::array<float, 3>> selected(const MatrixX3d& vectors, const std::vector<int>& rows) {
  std::vector<std::array<float, 3>> out;
  for (const int row : rows)
    out.push_back({static_cast<float>(vectors(row, 0)),
                   static_cast<float>(vectors(row, 1)),
                   static_cast<float>(vectors(row, 2))});
  return out;
}

/// The skeleton's nodes from `first` on; returns the topmost.
std::vector<int> add_nodes(tinygltf::Model& model, const Skin& skin, int first) {
  std::vector<int> tops;
  for (std::size_t n = 0; n < skin.nodes.size(); ++n) {
    const SkeletonNode& from = skin.nodes[n];
    tinygltf::Node node;
    node.name = from.name;
    const Vector3d place = from.local.topRightCorner<3, 1>();
    if (!place.isZero(0)) node.translation = {place[0], place[1], place[2]};
    const int index = first + static_cast<int>(n);
    if (from.parent < 0)
      tops.push_back(index);
    else
      model.nodes[idx(first + from.parent)].children.push_back(index);
    model.nodes.push_back(std::move(node));
  }
  return tops;
}

void add_skin(tinygltf::Model& model, const Skin& from, int first, int top) {
  tinygltf::Skin skin;
  skin.skeleton = top;
  std::vector<float> matrices;
  for (const int j : from.joints) {
    skin.joints.push_back(first + j);
    // The frame is not turned: its inverse moves back.
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.topRightCorner<3, 1>() = -from.nodes[idx(j)].bind.topRightCorner<3, 1>().cast<float>();
    matrices.insert(matrices.end(), inverse.data(), inverse.data() + 16);
  }
  const int view = add_view(model, matrices.data(), matrices.size() * sizeof(float), 0);
  skin.inverseBindMatrices = add_accessor(
      model, view, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4, from.joints.size());
  model.skins.push_back(std::move(skin));
}

int type_of(TrackPath path) {
  if (path == TrackPath::kWeights) return TINYGLTF_TYPE_SCALAR;
  return path == TrackPath::kRotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3;
}

const char* name_of(TrackPath path) {
  switch (path) {
    case TrackPath::kTranslation:
      return "translation";
    case TrackPath::kRotation:
      return "rotation";
    case TrackPath::kScale:
      return "scale";
    case TrackPath::kWeights:
      break;
  }
  return "weights";
}

const char* name_of(Interpolation interpolation) {
  if (interpolation == Interpolation::kStep) return "STEP";
  return interpolation == Interpolation::kLinear ? "LINEAR" : "CUBICSPLINE";
}

class AnimationWriter {
 public:
  AnimationWriter(tinygltf::Model& model, int first_node) : model_(model), first_(first_node) {}

  void write(const Animation& from) {
    tinygltf::Animation animation;
    animation.name = from.name;
    for (const Track& track : from.tracks) {
      tinygltf::AnimationSampler sampler;
      sampler.input = times(track.times);
      sampler.output = values(track);
      sampler.interpolation = name_of(track.interpolation);
      tinygltf::AnimationChannel channel;
      channel.sampler = static_cast<int>(animation.samplers.size());
      channel.target_node = track.node < 0 ? 0 : first_ + track.node;
      channel.target_path = name_of(track.path);
      animation.samplers.push_back(std::move(sampler));
      animation.channels.push_back(std::move(channel));
    }
    model_.animations.push_back(std::move(animation));
  }

 private:
  /// Tracks that share their times share an accessor.
  int times(const std::vector<double>& seconds) {
    const std::vector<float> narrow(seconds.begin(), seconds.end());
    const auto [entry, fresh] = times_.try_emplace(narrow, -1);
    if (!fresh) return entry->second;
    entry->second = numbers(narrow, TINYGLTF_TYPE_SCALAR, narrow.size());
    add_bounds(model_, entry->second, narrow.data(), 1);
    return entry->second;
  }

  int values(const Track& track) {
    const std::vector<float> narrow(track.values.begin(), track.values.end());
    const std::size_t width = track.path == TrackPath::kWeights ? 1 : idx(track.width);
    return numbers(narrow, type_of(track.path), narrow.size() / width);
  }

  int numbers(const std::vector<float>& values, int type, std::size_t count) {
    const int view = add_view(model_, values.data(), values.size() * sizeof(float), 0);
    return add_accessor(model_, view, TINYGLTF_COMPONENT_TYPE_FLOAT, type, count);
  }

  tinygltf::Model& model_;
  int first_;
  std::map<std::vector<float>, int> times_;
};

void name_targets(tinygltf::Mesh& mesh, const std::vector<MorphTarget>& morphs) {
  tinygltf::Value::Array names;
  bool named = false;
  for (const MorphTarget& morph : morphs) {
    mesh.weights.push_back(morph.weight);
    names.emplace_back(morph.name);
    named = named || !morph.name.empty();
  }
  if (named)
    mesh.extras = tinygltf::Value(tinygltf::Value::Object{{"targetNames", tinygltf::Value(names)}});
}

}  // namespace

void write_moving_vertices(tinygltf::Model& model,
                           const Motion& motion,
                           const std::vector<int>& rows,
                           tinygltf::Primitive& primitive) {
  if (motion.skin) {
    const bool narrow = motion.skin->joints.size() <= 256;
    primitive.attributes["JOINTS_0"] =
        narrow ? add_joints<std::uint8_t>(
                     model, *motion.skin, rows, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
               : add_joints<std::uint16_t>(
                     model, *motion.skin, rows, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
    primitive.attributes["WEIGHTS_0"] = add_weights(model, *motion.skin, rows);
  }
  for (const MorphTarget& morph : motion.morphs) {
    std::map<std::string, int> target;
    target["POSITION"] = add_places(model, selected(morph.displacements, rows));
    if (morph.normal_displacements.rows() > 0)
      target["NORMAL"] = add_places(model, selected(morph.normal_displacements, rows));
    primitive.targets.push_back(std::move(target));
  }
}

std::vector<int> write_motion(tinygltf::Model& model, const TexturedMesh& mesh) {
  const Motion& motion = mesh.motion;
  name_targets(model.meshes[0], motion.morphs);
  std::vector<int> beside;
  const int first = static_cast<int>(model.nodes.size());
  if (motion.skin) {
    beside = add_nodes(model, *motion.skin, first);
    const bool moved = !mesh.node_transform.isIdentity(0);
    if (moved || beside.size() > 1) {
      tinygltf::Node top;
      top.name = "skeleton";
      if (moved) top.matrix.assign(mesh.node_transform.data(), mesh.node_transform.data() + 16);
      top.children = beside;
      beside = {static_cast<int>(model.nodes.size())};
      model.nodes.push_back(std::move(top));
    }
    add_skin(model, *motion.skin, first, beside.front());
    model.nodes[0].skin = 0;
    model.nodes[0].matrix.clear();
  }
  AnimationWriter animations(model, first);
  for (const Animation& animation : motion.animations) animations.write(animation);
  return beside;
}

}  // namespace crosspatch
