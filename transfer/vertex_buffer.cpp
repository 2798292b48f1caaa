#include "transfer/vertex_buffer.hpp"

#include <string>
#include <unordered_map>

#include "core/index.hpp"
#include "transfer/tangents.hpp"

namespace crosspatch {
namespace {

std::array<float, 3> to_float(const Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

class Welder {
 public:
  Welder(const TexturedMesh& mesh, int material, int tangent_uv_set)
      : mesh_(mesh), moves_(mesh.motion.skin || !mesh.motion.morphs.empty()) {
    buffer_.uv_sets.resize(mesh.uv_sets.size());
    if (tangent_uv_set >= 0) tangents_ = corner_tangents(mesh, material, tangent_uv_set);
  }

  void add(int t) {
    std::array<std::array<float, 3>, 3> p;
    for (int k = 0; k < 3; ++k)
      p[idx(k)] = to_float(mesh_.positions.row(mesh_.triangles(t, k)).transpose());
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) return;
    for (int k = 0; k < 3; ++k) buffer_.indices.push_back(vertex(t, k, p[idx(k)]));
  }

  VertexBuffer finish() { return std::move(buffer_); }

 private:
  std::array<float, 4> tangent(int corner) const {
    const Eigen::Vector4d& t = tangents_[idx(corner)];
    const auto unit = to_float(t.head<3>());
    return {unit[0], unit[1], unit[2], static_cast<float>(t[3])};
  }

  std::uint32_t vertex(int t, int k, const std::array<float, 3>& place) {
    key_.clear();
    const auto append = [&](const auto& values) {
      for (float value : values) {
        value += 0.F;  // -0 and 0 are one value
        key_.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
    };
    const int corner = 3 * t + k;
    const auto unit = to_float(shading_normal(mesh_, t, k));
    const int row = mesh_.triangles(t, k);
    if (moves_) key_.append(reinterpret_cast<const char*>(&row), sizeof row);
    append(place);
    append(unit);
    std::vector<std::array<float, 2>> uvs;
    for (const auto& set : mesh_.uv_sets)
      uvs.push_back(
          {static_cast<float>(set[idx(corner)][0]), static_cast<float>(set[idx(corner)][1])});
    for (const auto& value : uvs) append(value);
    if (!mesh_.colors.empty()) append(mesh_.colors[idx(corner)]);
    if (!tangents_.empty()) append(tangent(corner));
    const auto [entry, fresh] =
        vertex_of_key_.try_emplace(key_, static_cast<std::uint32_t>(buffer_.positions.size()));
    if (!fresh) return entry->second;
    buffer_.rows.push_back(row);
    buffer_.positions.push_back(place);
    buffer_.normals.push_back(unit);
    for (std::size_t s = 0; s < uvs.size(); ++s) buffer_.uv_sets[s].push_back(uvs[s]);
    if (!mesh_.colors.empty()) buffer_.colors.push_back(mesh_.colors[idx(corner)]);
    if (!tangents_.empty()) buffer_.tangents.push_back(tangent(corner));
    return entry->second;
  }

  const TexturedMesh& mesh_;
  bool moves_;
  std::vector<Eigen::Vector4d> tangents_;  ///< per corner, or empty
  VertexBuffer buffer_;
  std::string key_;
  std::unordered_map<std::string, std::uint32_t> vertex_of_key_;
};

}  // namespace

VertexBuffer weld_corners(const TexturedMesh& mesh, int material, int tangent_uv_set) {
  Welder welder(mesh, material, tangent_uv_set);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    if (mesh.material[idx(t)] == material) welder.add(t);
  return welder.finish();
}

}  // namespace crosspatch
