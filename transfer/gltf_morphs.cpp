#include "transfer/gltf_morphs.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/index.hpp"
#include "transfer/gltf_accessor.hpp"

namespace crosspatch {
namespace {

Status bad(std::string message) {
  return fail(ErrorCode::kBadInput, std::move(message));
}

/// What exporters write the names of targets to.
std::vector<std::string> target_names(const tinygltf::Mesh& mesh, std::size_t count) {
  std::vector<std::string> names(count);
  if (!mesh.extras.IsObject() || !mesh.extras.Has("targetNames")) return names;
  const tinygltf::Value& list = mesh.extras.Get("targetNames");
  for (std::size_t i = 0; list.IsArray() && i < std::min(count, list.ArrayLen()); ++i)
    if (list.Get(static_cast<int>(i)).IsString())
      names[i] = list.Get(static_cast<int>(i)).Get<std::string>();
  return names;
}

class MorphReader {
 public:
  MorphReader(const tinygltf::Model& model,
              const std::vector<MeshInstance>& instances,
              const ReadLimits& limits)
      : model_(model), instances_(instances), limits_(limits) {}

  Result<ReadMorphs> read() {
    for (const MeshInstance& instance : instances_)
      if (Status s = declare(instance); !s)
        return fail(s.error().code, fmt::format("mesh {}: {}", instance.mesh, s.error().message));
    if (out_.morphs.empty()) return fail(ErrorCode::kBadInput, "no mesh of it has morph targets");
    const std::int64_t targets = static_cast<std::int64_t>(out_.morphs.size());
    if (vertices_ > kMostDisplacements / targets)
      return fail(ErrorCode::kBadInput,
                  fmt::format("{} morph targets of {} vertices, at most {} displacements are read",
                              targets,
                              vertices_,
                              kMostDisplacements));
    for (MorphTarget& morph : out_.morphs) morph.displacements.setZero(vertices_, 3);
    vertices_ = 0;
    for (const MeshInstance& instance : instances_)
      for (const auto& primitive : model_.meshes[idx(instance.mesh)].primitives)
        if (has_triangles(primitive))
          if (Status s = add(primitive, to_first(instances_, instance)); !s)
            return fail(s.error().code,
                        fmt::format("mesh {}: {}", instance.mesh, s.error().message));
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::size_t count(const tinygltf::Primitive& primitive) const {
    return model_.accessors[idx(primitive.attributes.at("POSITION"))].count;
  }

  /// Counts the vertices of an instance, and names its targets or compares them with those before.
  Status declare(const MeshInstance& instance) {
    const tinygltf::Mesh& mesh = model_.meshes[idx(instance.mesh)];
    std::size_t targets = 0;
    bool first = true;
    for (const auto& primitive : mesh.primitives) {
      if (!has_triangles(primitive)) continue;
      vertices_ += static_cast<std::int64_t>(count(primitive));
      if (vertices_ > limits_.max_vertices)
        return bad(fmt::format("more than {} vertices", limits_.max_vertices));
      if (!first && primitive.targets.size() != targets)
        return bad(fmt::format(
            "a primitive has {} morph targets, another {}", primitive.targets.size(), targets));
      targets = primitive.targets.size();
      first = false;
    }
    if (targets == 0) return {};
    const auto& own = model_.nodes[idx(instance.node)].weights;
    const std::vector<double>& weights = own.empty() ? mesh.weights : own;
    if (!weights.empty() && weights.size() != targets)
      return bad(fmt::format("{} weights for {} morph targets", weights.size(), targets));
    const std::vector<std::string> names = target_names(mesh, targets);
    if (out_.morphs.empty()) {
      for (std::size_t i = 0; i < targets; ++i) {
        MorphTarget morph;
        morph.name = names[i];
        morph.weight = weights.empty() ? 0 : weights[i];
        if (!std::isfinite(morph.weight))
          return bad(fmt::format("morph target {} has weight {}", i, morph.weight));
        out_.morphs.push_back(std::move(morph));
      }
    } else if (targets != out_.morphs.size()) {
      return bad(
          fmt::format("has {} morph targets, a mesh before it {}", targets, out_.morphs.size()));
    } else {
      for (std::size_t i = 0; i < targets; ++i)
        if (names[i] != out_.morphs[i].name)
          return bad(fmt::format("its morph target {} has another name than a mesh's before", i));
    }
    out_.file_nodes.push_back(instance.node);
    return {};
  }

  Status add(const tinygltf::Primitive& primitive, const Eigen::Matrix4d& transform) {
    const std::size_t rows = count(primitive);
    const Eigen::Matrix3d linear = transform.topLeftCorner<3, 3>();
    const Eigen::Matrix3d turn = Eigen::Affine3d(transform).rotation();
    for (std::size_t i = 0; i < primitive.targets.size(); ++i) {
      MorphTarget& morph = out_.morphs[i];
      if (Status s =
              add_values(primitive.targets[i], "POSITION", rows, linear, morph.displacements);
          !s)
        return fail(s.error().code, fmt::format("morph target {}: {}", i, s.error().message));
      if (primitive.targets[i].count("NORMAL") == 0) continue;
      if (morph.normal_displacements.rows() == 0)
        morph.normal_displacements.setZero(morph.displacements.rows(), 3);
      if (Status s =
              add_values(primitive.targets[i], "NORMAL", rows, turn, morph.normal_displacements);
          !s)
        return fail(s.error().code, fmt::format("morph target {}: {}", i, s.error().message));
    }
    vertices_ += static_cast<std::int64_t>(rows);
    return {};
  }

  Status add_values(const std::map<std::string, int>& target,
                    const char* name,
                    std::size_t rows,
                    const Eigen::Matrix3d& linear,
                    MatrixX3d& to) {
    const auto accessor = target.find(name);
    if (accessor == target.end()) return {};
    const auto values = read_accessor(model_, accessor->second, limits_.max_vertices);
    if (!values) return tl::unexpected(values.error());
    if (values->components != 3 || values->count() != rows)
      return bad(fmt::format("{} has {} elements of {} for {} vertices",
                             name,
                             values->count(),
                             values->components,
                             rows));
    for (std::size_t v = 0; v < rows; ++v) {
      const Vector3d d = linear * Vector3d(&values->values[3 * v]);
      if (!d.allFinite()) return bad(fmt::format("the {} of vertex {} is not finite", name, v));
      to.row(vertices_ + static_cast<Eigen::Index>(v)) = d.transpose();
    }
    return {};
  }

  const tinygltf::Model& model_;
  const std::vector<MeshInstance>& instances_;
  const ReadLimits& limits_;
  std::int64_t vertices_ = 0;
  ReadMorphs out_;
};

}  // namespace

Result<ReadMorphs> read_morphs(const tinygltf::Model& model,
                               const std::vector<MeshInstance>& instances,
                               const ReadLimits& limits) {
  return MorphReader(model, instances, limits).read();
}

}  // namespace crosspatch
