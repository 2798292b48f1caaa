#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "core/result.hpp"
#include "transfer/texel_raster.hpp"
#include "transfer/texture_pyramid.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

/// The images a glTF material can have.
enum class Channel { kBaseColor, kMetallicRoughness, kNormal, kOcclusion, kEmissive };
inline constexpr std::array kChannels{Channel::kBaseColor,
                                      Channel::kMetallicRoughness,
                                      Channel::kNormal,
                                      Channel::kOcclusion,
                                      Channel::kEmissive};

const TextureRef& texture_of(const Material& material, Channel channel);

/// One channel of how a mesh looks, ready to be evaluated anywhere on it. The mesh must outlive it.
///
/// Values are linear in [0, 1]: colour times alpha and alpha (base colour; alpha is 1 where the
/// material is opaque), occlusion, roughness, metalness in red, green, blue, emission; normals
/// n as (n + 1) / 2.
class SourceLook {
 public:
  /// A triangle that is being painted.
  struct Triangle {
    const TexturePyramid* texture = nullptr;  ///< or none
    const TextureRef* ref = nullptr;
    const Material* material = nullptr;
    bool opaque = true;
    std::array<Eigen::Vector2f, 3> uv;  ///< texture transform applied
    Footprint footprint;
    Eigen::Array4f factor = Eigen::Array4f::Ones();
    int index = 0;
  };

  /// kBadInput when an image in use cannot be decoded.
  static Result<SourceLook> make(const TexturedMesh& mesh, Channel channel);

  /// For values at points, unfiltered.
  [[nodiscard]] Triangle triangle(int t) const;

  /// For means over texels. `corner`: where the corners of triangle t lie in the image to be
  /// painted, in texels.
  [[nodiscard]] Triangle triangle(int t, const std::array<Vector2d, 3>& corner) const;

  [[nodiscard]] Eigen::Array4f at(const Triangle& triangle, const Vector3d& bary) const;

  /// The values of a span's texels, in 65535ths, channels() a texel; points beside the triangle, as
  /// rounding has them, count as on its sides.
  void paint(const Triangle& triangle, const TexelSpan& span, std::uint16_t* values) const;

  /// 4 where any value may have an alpha below 1, else 3.
  [[nodiscard]] int channels() const { return has_alpha_ ? 4 : 3; }

  /// For normals: the tangents that the painted image will be read with, one a corner of the mesh;
  /// see corner_tangents.
  void set_target_tangents(std::vector<Eigen::Vector4d> tangents) {
    target_tangents_ = std::move(tangents);
  }

 private:
  SourceLook(const TexturedMesh& mesh, Channel channel) : mesh_(&mesh), channel_(channel) {}
  Status load(int material);
  [[nodiscard]] Eigen::Array4f turned(const Triangle& triangle,
                                      const Vector3d& bary,
                                      Eigen::Array4f value) const;

  const TexturedMesh* mesh_;
  Channel channel_;
  bool has_alpha_ = false;
  std::map<std::pair<int, bool>, TexturePyramid> textures_;  ///< by image and premultiplication
  std::vector<Eigen::Vector4d> tangents_;                    ///< per corner; normals only
  std::vector<Eigen::Vector4d> target_tangents_;
};

}  // namespace crosspatch
