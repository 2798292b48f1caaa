#include "transfer/vertex_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <unordered_map>

#include "core/index.hpp"

namespace crosspatch {
namespace {

using Eigen::Index;

std::array<float, 3> to_float(const Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

class Welder {
 public:
  Welder(const TexturedMesh& mesh, int tangent_uv_set)
      : mesh_(mesh), tangent_uv_set_(tangent_uv_set) {
    buffer_.uv_sets.resize(mesh.uv_sets.size());
  }

  void add(int t) {
    std::array<std::array<float, 3>, 3> p;
    for (int k = 0; k < 3; ++k)
      p[idx(k)] = to_float(mesh_.positions.row(mesh_.triangles(t, k)).transpose());
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) {
      ++buffer_.dropped_triangles;
      return;
    }
    const float side = uv_side(t);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = vertex(t, k, p[idx(k)], side);
      buffer_.indices.push_back(v);
      if (tangent_uv_set_ >= 0) add_tangent(t, k, v);
    }
  }

  VertexBuffer finish() {
    for (std::size_t v = 0; v < tangent_sum_.size(); ++v) {
      const Vector3d n(buffer_.normals[v][0], buffer_.normals[v][1], buffer_.normals[v][2]);
      Vector3d d = tangent_sum_[v] - n * n.dot(tangent_sum_[v]);
      // UVs without extent name no direction: any one in the normal's plane serves.
      if (d.norm() < 1e-12) d = n.unitOrthogonal();
      const auto unit = to_float(d.normalized());
      buffer_.tangents.push_back({unit[0], unit[1], unit[2], side_[v]});
    }
    return std::move(buffer_);
  }

 private:
  Vector3d position(int t, int k) const {
    return mesh_.positions.row(mesh_.triangles(t, k % 3)).transpose();
  }

  const Vector2d& uv(int t, int k) const {
    return mesh_.uv_sets[idx(tangent_uv_set_)][idx(3 * t + k % 3)];
  }

  /// glTF's bitangent is cross(normal, tangent) * w and follows v upwards, whereas v of the UVs
  /// grows downwards.
  float uv_side(int t) const {
    if (tangent_uv_set_ < 0) return 0;
    const Vector2d a = uv(t, 1) - uv(t, 0), b = uv(t, 2) - uv(t, 0);
    return a[0] * b[1] - a[1] * b[0] > 0 ? -1.F : 1.F;
  }

  std::uint32_t vertex(int t, int k, const std::array<float, 3>& place, float side) {
    Vector3d normal = mesh_.normals[idx(3 * t + k)];
    if (normal.isZero(0))
      normal = (position(t, 1) - position(t, 0)).cross(position(t, 2) - position(t, 0));
    normal = normal.norm() > 0 ? Vector3d(normal.normalized()) : Vector3d::UnitZ();
    key_.clear();
    const auto append = [&](const auto& values) {
      for (float value : values) {
        value += 0.F;  // -0 and 0 are one value
        key_.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
    };
    const auto unit = to_float(normal);
    append(place);
    append(unit);
    std::vector<std::array<float, 2>> uvs;
    for (const auto& set : mesh_.uv_sets)
      uvs.push_back(
          {static_cast<float>(set[idx(3 * t + k)][0]), static_cast<float>(set[idx(3 * t + k)][1])});
    for (const auto& value : uvs) append(value);
    if (!mesh_.colors.empty()) append(mesh_.colors[idx(3 * t + k)]);
    append(std::array<float, 1>{side});
    const auto [entry, fresh] =
        vertex_of_key_.try_emplace(key_, static_cast<std::uint32_t>(buffer_.positions.size()));
    if (!fresh) return entry->second;
    buffer_.positions.push_back(place);
    buffer_.normals.push_back(unit);
    for (std::size_t s = 0; s < uvs.size(); ++s) buffer_.uv_sets[s].push_back(uvs[s]);
    if (!mesh_.colors.empty()) buffer_.colors.push_back(mesh_.colors[idx(3 * t + k)]);
    if (tangent_uv_set_ >= 0) {
      tangent_sum_.emplace_back(Vector3d::Zero());
      side_.push_back(side);
    }
    return entry->second;
  }

  void add_tangent(int t, int k, std::uint32_t v) {
    const Vector3d e1 = position(t, 1) - position(t, 0), e2 = position(t, 2) - position(t, 0);
    const Vector2d d1 = uv(t, 1) - uv(t, 0), d2 = uv(t, 2) - uv(t, 0);
    const double area = d1[0] * d2[1] - d1[1] * d2[0];
    Vector3d along_u = e1 * d2[1] - e2 * d1[1];
    if (area < 0) along_u = -along_u;
    if (area == 0 || along_u.norm() == 0) return;
    const Vector3d to_next = position(t, k + 1) - position(t, k);
    const Vector3d to_last = position(t, k + 2) - position(t, k);
    const double angle = std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last));
    const auto& n = buffer_.normals[v];
    const Vector3d normal(n[0], n[1], n[2]);
    const Vector3d flat = along_u - normal * normal.dot(along_u);
    if (flat.norm() > 0) tangent_sum_[v] += angle * flat.normalized();
  }

  const TexturedMesh& mesh_;
  int tangent_uv_set_;
  VertexBuffer buffer_;
  std::string key_;
  std::unordered_map<std::string, std::uint32_t> vertex_of_key_;
  std::vector<Vector3d> tangent_sum_;  ///< per vertex
  std::vector<float> side_;            ///< per vertex
};

}  // namespace

VertexBuffer weld_corners(const TexturedMesh& mesh, int material, int tangent_uv_set) {
  Welder welder(mesh, tangent_uv_set);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    if (mesh.material[idx(t)] == material) welder.add(t);
  return welder.finish();
}

}  // namespace crosspatch
