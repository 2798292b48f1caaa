#include "transfer/gltf_materials.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

namespace crosspatch {
namespace {

double number(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return fallback;
  const double value = object.Get(key).GetNumberAsDouble();
  return std::isfinite(value) ? value : fallback;
}

Vector2d pair(const tinygltf::Value& object, const char* key, const Vector2d& fallback) {
  if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() != 2)
    return fallback;
  Vector2d out = fallback;
  for (int k = 0; k < 2; ++k) {
    const tinygltf::Value& entry = object.Get(key).Get(k);
    if (entry.IsNumber() && std::isfinite(entry.GetNumberAsDouble()))
      out[k] = entry.GetNumberAsDouble();
  }
  return out;
}

/// The texture a texture info names, with its sampler and KHR_texture_transform.
template <class Info>
TextureRef texture(const tinygltf::Model& model,
                   const Info& info,
                   const std::map<int, int>& image_of) {
  TextureRef ref;
  if (info.index < 0) return ref;
  const tinygltf::Texture& source = model.textures[static_cast<std::size_t>(info.index)];
  const auto image = image_of.find(source.source);
  if (image == image_of.end()) return ref;
  ref.image = image->second;
  ref.uv_set = std::max(info.texCoord, 0);
  if (source.sampler >= 0) {
    const tinygltf::Sampler& sampler = model.samplers[static_cast<std::size_t>(source.sampler)];
    ref.wrap_s = sampler.wrapS;
    ref.wrap_t = sampler.wrapT;
    ref.min_filter = sampler.minFilter;
    ref.mag_filter = sampler.magFilter;
  }
  const auto extension = info.extensions.find("KHR_texture_transform");
  if (extension == info.extensions.end() || !extension->second.IsObject()) return ref;
  const tinygltf::Value& transform = extension->second;
  ref.transform = TextureTransform{pair(transform, "offset", {0, 0}),
                                   number(transform, "rotation", 0),
                                   pair(transform, "scale", {1, 1})};
  constexpr double kMostSets = 1000;  // an int for sure
  ref.uv_set =
      static_cast<int>(std::clamp(number(transform, "texCoord", ref.uv_set), 0.0, kMostSets));
  return ref;
}

template <std::size_t N>
void copy_factor(const std::vector<double>& from, std::array<double, N>& to) {
  if (from.size() != N) return;
  std::copy(from.begin(), from.end(), to.begin());
}

}  // namespace

std::vector<Material> gltf_materials(const tinygltf::Model& model,
                                     const std::map<int, int>& image_of) {
  std::vector<Material> out;
  for (const tinygltf::Material& from : model.materials) {
    Material& to = out.emplace_back();
    const auto& pbr = from.pbrMetallicRoughness;
    to.name = from.name;
    copy_factor(pbr.baseColorFactor, to.base_color_factor);
    copy_factor(from.emissiveFactor, to.emissive_factor);
    to.metallic_factor = pbr.metallicFactor;
    to.roughness_factor = pbr.roughnessFactor;
    if (from.alphaMode == "MASK" || from.alphaMode == "BLEND") to.alpha_mode = from.alphaMode;
    to.alpha_cutoff = from.alphaCutoff;
    to.double_sided = from.doubleSided;
    to.base_color = texture(model, pbr.baseColorTexture, image_of);
    to.metallic_roughness = texture(model, pbr.metallicRoughnessTexture, image_of);
    to.normal = texture(model, from.normalTexture, image_of);
    to.normal.strength = from.normalTexture.scale;
    to.occlusion = texture(model, from.occlusionTexture, image_of);
    to.occlusion.strength = from.occlusionTexture.strength;
    to.emissive = texture(model, from.emissiveTexture, image_of);
  }
  return out;
}

}  // namespace crosspatch
