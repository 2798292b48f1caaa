#include "transfer/gltf_write.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "core/index.hpp"
#include "transfer/gltf_buffer.hpp"
#include "transfer/gltf_write_motion.hpp"
#include "transfer/vertex_buffer.hpp"

namespace crosspatch {
namespace {

class Writer {
 public:
  explicit Writer(const TexturedMesh& mesh) : mesh_(mesh) {
    model_.asset.version = "2.0";
    model_.asset.generator = "crosspatch";
    model_.buffers.resize(1);
  }

  Result<std::string> write() {
    if (Status s = build(); !s) return tl::unexpected(s.error());
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model_, stream, /*prettyPrint=*/false, /*binary=*/true))
      return fail(ErrorCode::kOutput, "GLB: the encoder failed");
    return stream.str();
  }

  /// Images and the buffer go to files of their own, which the JSON text names.
  Result<std::vector<NamedBytes>> write_files(const std::string& stem) {
    images_beside_ = true;
    if (Status s = build(); !s) return tl::unexpected(s.error());
    std::string buffer(model_.buffers[0].data.begin(), model_.buffers[0].data.end());
    const std::size_t size = buffer.size();
    // tinygltf would write the buffer as a data URI; the text is completed here instead.
    model_.buffers.clear();
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model_, stream, /*prettyPrint=*/false, /*binary=*/false))
      return fail(ErrorCode::kOutput, "glTF: the encoder failed");
    auto json = nlohmann::json::parse(stream.str(), nullptr, /*allow_exceptions=*/false);
    if (json.is_discarded()) return fail(ErrorCode::kInternal, "glTF: the encoder wrote no JSON");
    json["buffers"] = {{{"byteLength", size}, {"uri", uri(stem + ".bin")}}};
    std::vector<NamedBytes> files{{stem + ".gltf", ""}, {stem + ".bin", std::move(buffer)}};
    for (const auto& [image, place] : image_) {
      const ImageFile& file = mesh_.images[idx(image)];
      const std::string name = stem + "_" + file.name;
      json["images"][idx(place)] = {{"name", file.name}, {"uri", uri(name)}};
      files.push_back({name, {file.bytes.begin(), file.bytes.end()}});
    }
    files.front().bytes = json.dump(1);
    return files;
  }

 private:
  Status build() {
    tinygltf::Mesh out;
    for (int m = 0; m < static_cast<int>(mesh_.materials.size()); ++m) {
      const Material& material = mesh_.materials[idx(m)];
      const VertexBuffer vertices =
          weld_corners(mesh_, m, material.normal.image >= 0 ? material.normal.uv_set : -1);
      if (vertices.indices.empty()) continue;
      if (Status s = add_material(material); !s) return s;
      out.primitives.push_back(primitive(vertices));
    }
    if (out.primitives.empty())
      return fail(ErrorCode::kOutput, "GLB: there is no triangle to write");
    model_.meshes.push_back(std::move(out));
    add_scene();
    // Lengths are 32-bit in GLB; the JSON beside the buffer stays below 64 MiB for any real mesh.
    constexpr std::size_t kLargestBuffer = (std::size_t{1} << 32) - (std::size_t{1} << 26);
    const std::size_t size = model_.buffers[0].data.size();
    if (size > kLargestBuffer)
      return fail(ErrorCode::kOutput,
                  fmt::format("GLB: {} bytes of data, at most {} fit", size, kLargestBuffer));
    return {};
  }

  /// A file name as a URI: bytes that have a meaning there as %XX.
  static std::string uri(const std::string& name) {
    std::string text;
    for (const char c : name) {
      const auto byte = static_cast<unsigned char>(c);
      if (std::isalnum(byte) != 0 || c == '.' || c == '_' || c == '-' || c == '~')
        text += c;
      else
        text += fmt::format("%{:02X}", byte);
    }
    return text;
  }

  int add_indices(const VertexBuffer& vertices) {
    const auto add = [&](const auto& values, int component) {
      const int view = add_view(model_,
                                values.data(),
                                values.size() * sizeof values[0],
                                TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
      return add_accessor(model_, view, component, TINYGLTF_TYPE_SCALAR, values.size());
    };
    // 65535 itself restarts a primitive.
    if (vertices.positions.size() > std::numeric_limits<std::uint16_t>::max())
      return add(vertices.indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    std::vector<std::uint16_t> narrow;
    for (const std::uint32_t i : vertices.indices) narrow.push_back(static_cast<std::uint16_t>(i));
    return add(narrow, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  }

  tinygltf::Primitive primitive(const VertexBuffer& vertices) {
    tinygltf::Primitive p;
    p.mode = TINYGLTF_MODE_TRIANGLES;
    p.material = static_cast<int>(model_.materials.size()) - 1;
    p.attributes["POSITION"] = add_places(model_, vertices.positions);
    p.attributes["NORMAL"] =
        add_attribute(model_, vertices.normals, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
    if (!vertices.tangents.empty())
      p.attributes["TANGENT"] = add_attribute(
          model_, vertices.tangents, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4);
    for (std::size_t s = 0; s < vertices.uv_sets.size(); ++s)
      p.attributes[fmt::format("TEXCOORD_{}", s)] = add_attribute(
          model_, vertices.uv_sets[s], TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2);
    if (!vertices.colors.empty())
      p.attributes["COLOR_0"] =
          add_attribute(model_, vertices.colors, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4);
    write_moving_vertices(model_, mesh_.motion, vertices.rows, p);
    p.indices = add_indices(vertices);
    return p;
  }

  Result<int> add_image(int image) {
    if (const auto found = image_.find(image); found != image_.end()) return found->second;
    const ImageFile& file = mesh_.images[idx(image)];
    if (file.mime_type != "image/png" && file.mime_type != "image/jpeg")
      return fail(
          ErrorCode::kOutput,
          fmt::format("image \"{}\" is neither PNG nor JPEG: a GLB cannot hold it unchanged",
                      file.name));
    tinygltf::Image out;
    out.name = file.name;
    out.mimeType = file.mime_type;
    if (!images_beside_) out.bufferView = add_view(model_, file.bytes.data(), file.bytes.size(), 0);
    model_.images.push_back(std::move(out));
    return image_[image] = static_cast<int>(model_.images.size()) - 1;
  }

  int add_sampler(const TextureRef& ref) {
    tinygltf::Sampler sampler;
    sampler.wrapS = ref.wrap_s;
    sampler.wrapT = ref.wrap_t;
    sampler.minFilter = ref.min_filter;
    sampler.magFilter = ref.mag_filter;
    const auto [entry, fresh] =
        sampler_.try_emplace({ref.wrap_s, ref.wrap_t, ref.min_filter, ref.mag_filter},
                             static_cast<int>(model_.samplers.size()));
    if (fresh) model_.samplers.push_back(sampler);
    return entry->second;
  }

  Result<int> add_texture(const TextureRef& ref) {
    const auto image = add_image(ref.image);
    if (!image) return tl::unexpected(image.error());
    tinygltf::Texture texture;
    texture.source = *image;
    texture.sampler = add_sampler(ref);
    const auto [entry, fresh] = texture_.try_emplace({texture.source, texture.sampler},
                                                     static_cast<int>(model_.textures.size()));
    if (fresh) model_.textures.push_back(texture);
    return entry->second;
  }

  template <class Info>
  Status set_texture(const TextureRef& ref, Info& info) {
    if (ref.image < 0) return {};
    const auto texture = add_texture(ref);
    if (!texture) return tl::unexpected(texture.error());
    info.index = *texture;
    info.texCoord = ref.uv_set;
    if (!ref.transform) return {};
    const TextureTransform& t = *ref.transform;
    tinygltf::Value::Object object;
    const auto pair = [](const Vector2d& v) {
      return tinygltf::Value(tinygltf::Value::Array{tinygltf::Value(v[0]), tinygltf::Value(v[1])});
    };
    object["offset"] = pair(t.offset);
    object["rotation"] = tinygltf::Value(t.rotation_radians);
    object["scale"] = pair(t.scale);
    info.extensions["KHR_texture_transform"] = tinygltf::Value(object);
    model_.extensionsUsed = {"KHR_texture_transform"};
    return {};
  }

  Status add_material(const Material& m) {
    tinygltf::Material out;
    out.name = m.name;
    auto& pbr = out.pbrMetallicRoughness;
    pbr.baseColorFactor.assign(m.base_color_factor.begin(), m.base_color_factor.end());
    pbr.metallicFactor = m.metallic_factor;
    pbr.roughnessFactor = m.roughness_factor;
    out.emissiveFactor.assign(m.emissive_factor.begin(), m.emissive_factor.end());
    out.alphaMode = m.alpha_mode;
    out.alphaCutoff = m.alpha_cutoff;
    out.doubleSided = m.double_sided;
    out.normalTexture.scale = m.normal.strength;
    out.occlusionTexture.strength = m.occlusion.strength;
    if (Status s = set_texture(m.base_color, pbr.baseColorTexture); !s) return s;
    if (Status s = set_texture(m.metallic_roughness, pbr.metallicRoughnessTexture); !s) return s;
    if (Status s = set_texture(m.normal, out.normalTexture); !s) return s;
    if (Status s = set_texture(m.occlusion, out.occlusionTexture); !s) return s;
    if (Status s = set_texture(m.emissive, out.emissiveTexture); !s) return s;
    model_.materials.push_back(std::move(out));
    return {};
  }

  void add_scene() {
    tinygltf::Node node;
    node.mesh = 0;
    if (!mesh_.node_transform.isIdentity(0))  // column-major in both
      node.matrix.assign(mesh_.node_transform.data(), mesh_.node_transform.data() + 16);
    model_.nodes.push_back(node);
    tinygltf::Scene scene;
    scene.nodes = {0};
    for (const int beside : write_motion(model_, mesh_)) scene.nodes.push_back(beside);
    model_.scenes.push_back(scene);
    model_.defaultScene = 0;
  }

  const TexturedMesh& mesh_;
  tinygltf::Model model_;
  bool images_beside_ = false;
  std::map<int, int> image_;
  std::map<std::tuple<int, int, int, int>, int> sampler_;
  std::map<std::pair<int, int>, int> texture_;
};

}  // namespace

Result<std::string> encode_glb(const TexturedMesh& mesh) {
  if (Status s = validate(mesh); !s) return tl::unexpected(s.error());
  return Writer(mesh).write();
}

Result<std::vector<NamedBytes>> encode_gltf(const TexturedMesh& mesh, const std::string& stem) {
  if (Status s = validate(mesh); !s) return tl::unexpected(s.error());
  return Writer(mesh).write_files(stem);
}

}  // namespace crosspatch
