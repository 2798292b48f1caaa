#include "transfer/tangents.hpp"

#include <array>
#include <cmath>
#include <map>

#include "core/index.hpp"

namespace crosspatch {
namespace {

Vector3d position(const TexturedMesh& mesh, int t, int k) {
  return mesh.positions.row(mesh.triangles(t, k % 3)).transpose();
}

/// One triangle's share in the tangent at its corner k: a unit vector in the normal's plane along
/// increasing u, times the corner's angle.
Vector3d share(const TexturedMesh& mesh, int uv_set, int t, int k, const Vector3d& normal) {
  const auto uv = [&](int j) { return mesh.uv_sets[idx(uv_set)][idx(3 * t + j)]; };
  const Vector3d e1 = position(mesh, t, 1) - position(mesh, t, 0);
  const Vector3d e2 = position(mesh, t, 2) - position(mesh, t, 0);
  const Vector2d d1 = uv(1) - uv(0), d2 = uv(2) - uv(0);
  const double area = d1[0] * d2[1] - d1[1] * d2[0];
  Vector3d along_u = e1 * d2[1] - e2 * d1[1];
  if (area < 0) along_u = -along_u;
  const Vector3d flat = along_u - normal * normal.dot(along_u);
  if (area == 0 || flat.norm() == 0) return Vector3d::Zero();
  const Vector3d to_next = position(mesh, t, k + 1) - position(mesh, t, k);
  const Vector3d to_last = position(mesh, t, k + 2) - position(mesh, t, k);
  return std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last)) * flat.normalized();
}

/// v grows downwards, bitangents point up.
double side(const TexturedMesh& mesh, int uv_set, int t) {
  const auto uv = [&](int j) { return mesh.uv_sets[idx(uv_set)][idx(3 * t + j)]; };
  const Vector2d a = uv(1) - uv(0), b = uv(2) - uv(0);
  return a[0] * b[1] - a[1] * b[0] > 0 ? -1 : 1;
}

}  // namespace

Vector3d shading_normal(const TexturedMesh& mesh, int t, int corner) {
  Vector3d normal = mesh.normals[idx(3 * t + corner)];
  if (normal.isZero(0))
    normal = (position(mesh, t, 1) - position(mesh, t, 0))
                 .cross(position(mesh, t, 2) - position(mesh, t, 0));
  return normal.norm() > 0 ? Vector3d(normal.normalized()) : Vector3d(Vector3d::UnitZ());
}

std::vector<Eigen::Vector4d> corner_tangents(const TexturedMesh& mesh, int material, int uv_set) {
  // Single precision tells corners apart as the written file will.
  using Key = std::array<float, 9>;
  std::map<Key, int> group_of;
  std::vector<Vector3d> sum;
  std::vector<int> group(3 * idx(mesh.triangle_count()), -1);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.material[idx(t)] != material) continue;
    const double w = side(mesh, uv_set, t);
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = position(mesh, t, k), n = shading_normal(mesh, t, k);
      const Vector2d uv = mesh.uv_sets[idx(uv_set)][idx(3 * t + k)];
      Key key{};
      const std::array<double, 9> values{p[0], p[1], p[2], n[0], n[1], n[2], uv[0], uv[1], w};
      for (std::size_t i = 0; i < key.size(); ++i) key[i] = static_cast<float>(values[i]) + 0.F;
      const auto [entry, fresh] = group_of.try_emplace(key, static_cast<int>(sum.size()));
      if (fresh) sum.emplace_back(Vector3d::Zero());
      group[idx(3 * t + k)] = entry->second;
      sum[idx(entry->second)] += share(mesh, uv_set, t, k, n);
    }
  }
  std::vector<Eigen::Vector4d> tangents(group.size(), Eigen::Vector4d::Zero());
  for (int c = 0; c < static_cast<int>(group.size()); ++c) {
    if (group[idx(c)] < 0) continue;
    const Vector3d n = shading_normal(mesh, c / 3, c % 3);
    Vector3d d = sum[idx(group[idx(c)])];
    d -= n * n.dot(d);
    // UVs without extent name no direction: any one in the normal's plane serves.
    if (d.norm() < 1e-12) d = n.unitOrthogonal();
    tangents[idx(c)] << d.normalized(), side(mesh, uv_set, c / 3);
  }
  return tangents;
}

}  // namespace crosspatch
