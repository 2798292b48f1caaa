#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "mesh_files.hpp"

// glTF files as JSON plus a binary part, for reader tests.
namespace crosspatch::files {

struct Gltf {
  nlohmann::json json;
  std::string binary;

  /// Appends bytes (padded to 4) as a buffer view and returns its index.
  int add_view(const std::string& bytes) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
    binary += bytes;
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    json["buffers"][0]["byteLength"] = binary.size();
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  int add_accessor(const std::string& bytes,
                   int component_type,
                   const std::string& type,
                   std::size_t count) {
    json["accessors"].push_back({{"bufferView", add_view(bytes)},
                                 {"componentType", component_type},
                                 {"type", type},
                                 {"count", count}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  [[nodiscard]] std::string glb() const {
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t n) { return bytes_of(static_cast<std::uint32_t>(n)); };
    return "glTF" + word(2) + word(12 + 8 + text.size() + 8 + binary.size()) + word(text.size()) +
           "JSON" + text + word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123, kUnsignedByte = 5121;

inline std::string floats(const std::vector<double>& values) {
  std::string out;
  for (const double v : values) out += bytes_of(static_cast<float>(v));
  return out;
}

/// One node, one mesh, one indexed primitive with POSITION and TEXCOORD_0 = (x, y), and a material
/// with one PNG of 4 x 4 in a buffer view.
inline Gltf gltf(const MatrixX3d& V, const MatrixX3i& F) {
  Gltf out;
  out.json = {{"asset", {{"version", "2.0"}}},
              {"scene", 0},
              {"scenes", {{{"nodes", {0}}}}},
              {"nodes", {{{"mesh", 0}}}},
              {"buffers", {{{"byteLength", 0}}}}};
  std::string positions, uv, indices;
  for (int v = 0; v < V.rows(); ++v) {
    positions += floats({V(v, 0), V(v, 1), V(v, 2)});
    uv += floats({V(v, 0), V(v, 1)});
  }
  for (int c = 0; c < F.size(); ++c)
    indices += bytes_of(static_cast<std::uint32_t>(F(c / 3, c % 3)));
  const std::size_t vertices = static_cast<std::size_t>(V.rows());
  const int p = out.add_accessor(positions, kFloat, "VEC3", vertices);
  const int t = out.add_accessor(uv, kFloat, "VEC2", vertices);
  const int i =
      out.add_accessor(indices, kUnsignedInt, "SCALAR", static_cast<std::size_t>(F.size()));
  const int image = out.add_view(png_header(4, 4));
  out.json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}, {"name", "skin"}}};
  out.json["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  out.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  out.json["materials"] = {
      {{"name", "m"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  out.json["meshes"] = {{{"primitives",
                          {{{"attributes", {{"POSITION", p}, {"TEXCOORD_0", t}}},
                            {"indices", i},
                            {"material", 0}}}}}};
  return out;
}

}  // namespace crosspatch::files
