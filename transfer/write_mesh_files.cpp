#include "transfer/write_mesh_files.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "core/index.hpp"
#include "transfer/gltf_write.hpp"
#include "transfer/obj_write.hpp"

namespace crosspatch {
namespace {

/// File names for the images: what they are called, made safe and different from each other.
void name_images(TexturedMesh& mesh) {
  std::set<std::string> taken;
  for (ImageFile& image : mesh.images) {
    std::filesystem::path name = std::filesystem::path(image.name).filename();
    std::string stem = name.stem().string(), extension = name.extension().string();
    for (char& c : stem)
      if (static_cast<unsigned char>(c) <= ' ' ||
          std::string("/\\:*?\"<>|#%").find(c) != std::string::npos)
        c = '_';
    if (stem.empty()) stem = "image";
    if (image.mime_type == "image/png") extension = ".png";
    if (image.mime_type == "image/jpeg") extension = ".jpg";
    std::string unique = stem + extension;
    for (int i = 2; !taken.insert(unique).second; ++i)
      unique = stem + "_" + std::to_string(i) + extension;
    image.name = unique;
  }
}

/// Leaves out images that no material in use refers to.
void drop_unused_images(TexturedMesh& mesh) {
  const auto refs = [](Material& m) {
    return std::array<TextureRef*, 5>{
        &m.base_color, &m.metallic_roughness, &m.normal, &m.occlusion, &m.emissive};
  };
  std::vector<int> place(mesh.images.size(), -1);
  std::vector<ImageFile> kept;
  for (const int material : std::set<int>(mesh.material.begin(), mesh.material.end()))
    for (TextureRef* ref : refs(mesh.materials[idx(material)])) {
      if (ref->image < 0) continue;
      int& to = place[idx(ref->image)];
      if (to < 0) {
        to = static_cast<int>(kept.size());
        kept.push_back(mesh.images[idx(ref->image)]);
      }
    }
  for (Material& m : mesh.materials)
    for (TextureRef* ref : refs(m))
      if (ref->image >= 0) ref->image = place[idx(ref->image)];
  mesh.images = std::move(kept);
}

}  // namespace

std::optional<MeshFormat> mesh_format(const std::string& file_name) {
  static const std::map<std::string, MeshFormat> formats{{".glb", MeshFormat::kGlb},
                                                         {".gltf", MeshFormat::kGltf},
                                                         {".obj", MeshFormat::kObj},
                                                         {".ply", MeshFormat::kPly}};
  std::string extension = std::filesystem::path(file_name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  const auto found = formats.find(extension);
  return found == formats.end() ? std::nullopt : std::optional(found->second);
}

Result<std::vector<NamedBytes>> encode_mesh_files(const TexturedMesh& mesh,
                                                  const std::string& name) {
  const std::optional<MeshFormat> format = mesh_format(name);
  if (!format) return fail(ErrorCode::kOutput, "'" + name + "' is no .glb, .gltf, .obj or .ply");
  const auto single = [&](std::string bytes) {
    return std::vector<NamedBytes>{{name, std::move(bytes)}};
  };
  if (*format == MeshFormat::kGlb) return encode_glb(mesh).map(single);
  if (Status s = validate(mesh); !s) return tl::unexpected(s.error());
  if (mesh.triangle_count() == 0) return fail(ErrorCode::kOutput, "there is no triangle to write");
  if (*format == MeshFormat::kPly) return encode_ply(mesh).map(single);
  TexturedMesh named = mesh;
  drop_unused_images(named);
  name_images(named);
  const std::string stem = std::filesystem::path(name).stem().string();
  std::vector<NamedBytes> files;
  if (*format == MeshFormat::kObj) {
    files = encode_obj(named, stem);
  } else {
    auto encoded = encode_gltf(named, stem);
    if (!encoded) return encoded;
    files = std::move(*encoded);
  }
  files.front().name = name;
  return files;
}

}  // namespace crosspatch
