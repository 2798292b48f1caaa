#include <fmt/format.h>

#include <array>
#include <cstring>
#include <map>

#include "core/index.hpp"
#include "transfer/obj_write.hpp"
#include "transfer/source_look.hpp"

namespace crosspatch {
namespace {

/// Place, normal and colour of a vertex.
struct PlyVertex {
  std::array<float, 6> place_and_normal{};
  std::array<std::uint8_t, 4> rgba{};
  auto operator<=>(const PlyVertex&) const = default;
};

template <class T>
void append_bytes(std::string& bytes, const T& value) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

std::array<std::uint8_t, 4> stored(const Eigen::Array4f& linear) {
  const float alpha = linear[3];
  std::array<std::uint8_t, 4> rgba{};
  for (int k = 0; k < 3; ++k) {
    const float plain = alpha > 0 ? std::min(1.0F, linear[k] / alpha) : linear[k];
    const auto wide =
        to_stored(static_cast<std::uint16_t>(std::lround(plain * 65535)), ColorSpace::kSrgb);
    rgba[idx(k)] = static_cast<std::uint8_t>((wide * 255U + 32767U) / 65535U);
  }
  rgba[3] = static_cast<std::uint8_t>(std::lround(alpha * 255));
  return rgba;
}

}  // namespace

Result<std::string> encode_ply(const TexturedMesh& mesh) {
  const Result<SourceLook> look = SourceLook::make(mesh, Channel::kBaseColor);
  if (!look) return tl::unexpected(look.error());
  const Eigen::Matrix3d linear = mesh.node_transform.topLeftCorner<3, 3>();
  const Vector3d shift = mesh.node_transform.topRightCorner<3, 1>();
  const Eigen::Matrix3d normal_matrix = linear.inverse().transpose();
  std::map<PlyVertex, std::int32_t> number;
  std::string vertices, faces;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const SourceLook::Triangle triangle = look->triangle(t);
    append_bytes(faces, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = linear * mesh.positions.row(mesh.triangles(t, k)).transpose() + shift;
      const Vector3d n = (normal_matrix * mesh.normals[idx(3 * t + k)]).stableNormalized();
      PlyVertex v;
      for (std::size_t i = 0; i < 3; ++i) {
        v.place_and_normal[i] = static_cast<float>(p[static_cast<int>(i)]) + 0.F;
        v.place_and_normal[3 + i] = static_cast<float>(n[static_cast<int>(i)]) + 0.F;
      }
      v.rgba = stored(look->at(triangle, Vector3d::Unit(k)));
      const auto [entry, fresh] = number.try_emplace(v, static_cast<std::int32_t>(number.size()));
      if (fresh) {
        append_bytes(vertices, v.place_and_normal);
        append_bytes(vertices, v.rgba);
      }
      append_bytes(faces, entry->second);
    }
  }
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\ncomment crosspatch\nelement vertex {}\n"
             "property float x\nproperty float y\nproperty float z\n"
             "property float nx\nproperty float ny\nproperty float nz\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\n"
             "property uchar alpha\nelement face {}\n"
             "property list uchar int vertex_indices\nend_header\n",
             number.size(),
             mesh.triangle_count()) +
         vertices + faces;
}

}  // namespace crosspatch
