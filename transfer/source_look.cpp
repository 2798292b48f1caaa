#include "transfer/source_look.hpp"

#include <Eigen/LU>
#include <cmath>
#include <set>

#include "core/index.hpp"
#include "transfer/tangents.hpp"
#include "transfer/texels_in_use.hpp"

namespace crosspatch {
namespace {

using Eigen::Array4f;

bool is_opaque(const Material& material) {
  return material.alpha_mode == "OPAQUE";
}

bool is_color(Channel channel) {
  return channel == Channel::kBaseColor || channel == Channel::kEmissive;
}

/// What the material multiplies its image by, and shows where it has none.
Array4f factor(const Material& m, Channel channel) {
  const auto f = [](double x) { return static_cast<float>(x); };
  if (channel == Channel::kBaseColor) {
    const auto& c = m.base_color_factor;
    const float alpha = is_opaque(m) ? 1.0F : f(c[3]);
    return {f(c[0]) * alpha, f(c[1]) * alpha, f(c[2]) * alpha, alpha};
  }
  if (channel == Channel::kMetallicRoughness)
    return {1, f(m.roughness_factor), f(m.metallic_factor), 1};
  if (channel == Channel::kEmissive)
    return {f(m.emissive_factor[0]), f(m.emissive_factor[1]), f(m.emissive_factor[2]), 1};
  return Array4f::Ones();
}

Eigen::Vector4d mix(const std::vector<Eigen::Vector4d>& values, int t, const Vector3d& bary) {
  return bary[0] * values[idx(3 * t)] + bary[1] * values[idx(3 * t + 1)] +
         bary[2] * values[idx(3 * t + 2)];
}

/// Columns tangent, bitangent, normal.
Eigen::Matrix3d frame(const Vector3d& normal, const Eigen::Vector4d& tangent) {
  Eigen::Matrix3d m;
  const Vector3d t = tangent.head<3>();
  m.col(0) = (t - normal * normal.dot(t)).normalized();
  m.col(1) = normal.cross(m.col(0)) * (tangent[3] < 0 ? -1 : 1);
  m.col(2) = normal;
  return m;
}

}  // namespace

const TextureRef& texture_of(const Material& m, Channel channel) {
  switch (channel) {
    case Channel::kBaseColor:
      return m.base_color;
    case Channel::kMetallicRoughness:
      return m.metallic_roughness;
    case Channel::kNormal:
      return m.normal;
    case Channel::kOcclusion:
      return m.occlusion;
    case Channel::kEmissive:
      break;
  }
  return m.emissive;
}

Result<SourceLook> SourceLook::make(const TexturedMesh& mesh, Channel channel) {
  SourceLook look(mesh, channel);
  for (const int m : std::set<int>(mesh.material.begin(), mesh.material.end()))
    if (Status s = look.load(m); !s) return tl::unexpected(s.error());
  return look;
}

Status SourceLook::load(int material) {
  const Material& m = mesh_->materials[idx(material)];
  const TextureRef& ref = texture_of(m, channel_);
  const bool premultiply = channel_ == Channel::kBaseColor && !is_opaque(m);
  has_alpha_ = has_alpha_ || premultiply;
  if (ref.image < 0) return {};
  if (channel_ == Channel::kNormal) {
    const auto tangents = corner_tangents(*mesh_, material, ref.uv_set);
    tangents_.resize(tangents.size(), Eigen::Vector4d::Zero());
    for (std::size_t c = 0; c < tangents.size(); ++c) tangents_[c] += tangents[c];
  }
  if (textures_.contains({ref.image, premultiply})) return {};
  const ImageFile& file = mesh_->images[idx(ref.image)];
  Result<RasterImage> image = decode_image_file(file.bytes, premultiply ? 4 : 3);
  if (!image)
    return fail(ErrorCode::kBadInput, "texture \"" + file.name + "\": " + image.error().message);
  const ColorSpace space = is_color(channel_) ? ColorSpace::kSrgb : ColorSpace::kLinear;
  // What lies between the islands of a texture, often black or white, must not run into them.
  std::vector<bool> in_use =
      texels_in_use(*mesh_, channel_, ref.image, {image->width, image->height});
  textures_[{ref.image, premultiply}] =
      make_pyramid(std::move(*image),
                   space,
                   premultiply ? Alpha::kPremultiplied : Alpha::kIgnored,
                   std::move(in_use));
  return {};
}

SourceLook::Triangle SourceLook::triangle(int t) const {
  const Material& m = mesh_->materials[idx(mesh_->material[idx(t)])];
  const TextureRef& ref = texture_of(m, channel_);
  Triangle triangle;
  triangle.index = t;
  triangle.ref = &ref;
  triangle.material = &m;
  triangle.opaque = is_opaque(m);
  triangle.factor = factor(m, channel_);
  if (ref.image < 0) return triangle;
  triangle.texture =
      &textures_.at({ref.image, channel_ == Channel::kBaseColor && !triangle.opaque});
  for (std::size_t k = 0; k < 3; ++k)
    triangle.uv[k] =
        transformed(mesh_->uv_sets[idx(ref.uv_set)][idx(3 * t) + k], ref.transform).cast<float>();
  return triangle;
}

SourceLook::Triangle SourceLook::triangle(int t, const std::array<Vector2d, 3>& corner) const {
  Triangle triangle = this->triangle(t);
  if (triangle.texture == nullptr) return triangle;
  std::array<Vector2d, 3> uv;
  for (std::size_t k = 0; k < 3; ++k)
    uv[k] = transformed(mesh_->uv_sets[idx(triangle.ref->uv_set)][idx(3 * t) + k],
                        triangle.ref->transform);
  Eigen::Matrix2d texels, change;
  texels << corner[1] - corner[0], corner[2] - corner[0];
  change << uv[1] - uv[0], uv[2] - uv[0];
  const Eigen::Matrix2d step = change * texels.inverse();
  if (step.allFinite()) triangle.footprint = footprint(*triangle.texture, step);
  return triangle;
}

Array4f SourceLook::at(const Triangle& triangle, const Vector3d& bary) const {
  Array4f value = Array4f::Ones();
  if (triangle.texture != nullptr) {
    const Eigen::Vector3f b = bary.cast<float>();
    const Eigen::Vector2f uv =
        b[0] * triangle.uv[0] + b[1] * triangle.uv[1] + b[2] * triangle.uv[2];
    value = sample(*triangle.texture, *triangle.ref, uv, triangle.footprint);
  }
  switch (channel_) {
    case Channel::kNormal:
      return triangle.texture != nullptr ? turned(triangle, bary, value)
                                         : Array4f(0.5F, 0.5F, 1, 1);
    case Channel::kOcclusion: {
      const float s = static_cast<float>(triangle.material->occlusion.strength);
      return triangle.texture != nullptr ? Array4f(1 + s * (value - 1)) : value;
    }
    case Channel::kBaseColor: {
      if (triangle.opaque) value[3] = 1;
      value *= triangle.factor;
      if (mesh_->colors.empty()) return value;
      Array4f color = Array4f::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& c = mesh_->colors[idx(3 * triangle.index) + k];
        color += static_cast<float>(bary[static_cast<int>(k)]) * Array4f(c[0], c[1], c[2], c[3]);
      }
      if (triangle.opaque) color[3] = 1;
      return value * color * Array4f(color[3], color[3], color[3], 1);
    }
    case Channel::kMetallicRoughness:
    case Channel::kEmissive:
      break;
  }
  return value * triangle.factor;
}

void SourceLook::paint(const Triangle& triangle,
                       const TexelSpan& span,
                       std::uint16_t* values) const {
  const int count = span.right - span.left + 1;
  const Vector3d first = span.at_zero + span.left * span.per_x;
  const Vector3d last = span.at_zero + span.right * span.per_x;
  const bool inside = first.minCoeff() >= 0 && last.minCoeff() >= 0;
  const bool plain = channel_ == Channel::kMetallicRoughness || channel_ == Channel::kEmissive ||
                     (channel_ == Channel::kBaseColor && mesh_->colors.empty());
  const auto add = [channels = channels(), &values](const FourFloats& value) {
    store_values(value, channels, values);
    values += channels;
  };
  if (inside && plain && triangle.texture != nullptr) {
    Vector2d uv = Vector2d::Zero(), step = Vector2d::Zero();
    for (int k = 0; k < 3; ++k) {
      uv += first[k] * triangle.uv[idx(k)].cast<double>();
      step += span.per_x[k] * triangle.uv[idx(k)].cast<double>();
    }
    const Array4f& f = triangle.factor;
    const FourFloats factors{f[0], f[1], f[2], f[3]};
    const bool opaque = triangle.opaque;
    sample_row(*triangle.texture,
               *triangle.ref,
               {uv, step, count},
               triangle.footprint,
               [&](FourFloats value) {
                 if (opaque) value[3] = 65535;
                 add(value * factors);
               });
    return;
  }
  for (int i = 0; i < count; ++i) {
    Vector3d bary = (first + i * span.per_x).cwiseMax(0.0);
    bary /= bary.sum();
    const Array4f value = at(triangle, bary);
    add(FourFloats{value[0], value[1], value[2], value[3]} * 65535);
  }
}

Array4f SourceLook::turned(const Triangle& triangle, const Vector3d& bary, Array4f value) const {
  const int t = triangle.index;
  const float strength = static_cast<float>(triangle.ref->strength);
  Vector3d n(static_cast<double>(2 * value[0] - 1) * strength,
             static_cast<double>(2 * value[1] - 1) * strength,
             static_cast<double>(2 * value[2] - 1));
  Vector3d normal = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) normal += bary[k] * shading_normal(*mesh_, t, k);
  if (normal.norm() < 1e-12) return {0.5F, 0.5F, 1, 1};
  normal.normalize();
  const Eigen::Matrix3d from = frame(normal, mix(tangents_, t, bary));
  const Eigen::Matrix3d to = frame(normal, mix(target_tangents_, t, bary));
  n = to.transpose() * (from * n);
  if (!n.allFinite() || n.norm() < 1e-12) return {0.5F, 0.5F, 1, 1};
  const Eigen::Vector3f unit = n.normalized().cast<float>();
  return {(unit[0] + 1) / 2, (unit[1] + 1) / 2, (unit[2] + 1) / 2, 1};
}

}  // namespace crosspatch
