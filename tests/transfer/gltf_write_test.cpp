#include "transfer/gltf_write.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/index.hpp"
#include "shapes.hpp"
#include "transfer/carry_texture.hpp"
#include "transfer/surfaces.hpp"
#include "transfer/vertex_buffer.hpp"

namespace crosspatch {
namespace {

using nlohmann::json;

struct Glb {
  json header;
  std::string binary;

  template <class T>
  [[nodiscard]] std::vector<T> values(int accessor) const {
    const json& a = header["accessors"][idx(accessor)];
    const json& view = header["bufferViews"][a["bufferView"].get<std::size_t>()];
    std::vector<T> out(view["byteLength"].get<std::size_t>() / sizeof(T));
    std::memcpy(
        out.data(), &binary[view.value("byteOffset", std::size_t{0})], out.size() * sizeof(T));
    return out;
  }
};

/// GLB 2.0: 12 bytes of header, a JSON chunk and a binary chunk, lengths little-endian.
Glb parse(const std::string& bytes) {
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bytes[at], 4);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), bytes.size());
  const std::size_t length = word(12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(bytes.substr(20 + length + 4, 3), "BIN");
  return {json::parse(bytes.substr(20, length)), bytes.substr(20 + length + 8)};
}

TexturedMesh textured_sphere() {
  shapes::Surface sphere = shapes::surface_of(shapes::icosphere(2));
  shapes::texture(
      sphere, [](int, const Vector3d& p) { return Vector2d(0.5 + p[0] / 2, 0.5 - p[1] / 2); }, 64);
  return carry_texture(sphere.view(), sphere.view(), identity_map(sphere.prepared.mesh))->mesh;
}

TEST(GltfWrite, ReadsBackEqual) {
  const TexturedMesh mesh = textured_sphere();
  const auto bytes = encode_glb(mesh);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const Glb glb = parse(*bytes);
  const json& primitive = glb.header["meshes"][0]["primitives"][0];
  const auto indices = glb.values<std::uint16_t>(primitive["indices"]);
  const auto places = glb.values<float>(primitive["attributes"]["POSITION"]);
  const auto normals = glb.values<float>(primitive["attributes"]["NORMAL"]);
  const auto uvs = glb.values<float>(primitive["attributes"]["TEXCOORD_0"]);
  ASSERT_EQ(indices.size(), idx(3 * mesh.triangle_count()));
  // No seam: every vertex is there once.
  EXPECT_EQ(places.size(), 3 * idx(static_cast<int>(mesh.positions.rows())));
  for (std::size_t c = 0; c < indices.size(); ++c) {
    const int t = static_cast<int>(c / 3), k = static_cast<int>(c % 3);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(places[3U * indices[c] + idx(i)],
                static_cast<float>(mesh.positions(mesh.triangles(t, k), i)));
      EXPECT_EQ(normals[3U * indices[c] + idx(i)], static_cast<float>(mesh.normals[c][i]));
    }
    for (int i = 0; i < 2; ++i)
      EXPECT_EQ(uvs[2U * indices[c] + idx(i)], static_cast<float>(mesh.uv_sets[0][c][i]));
  }
}

TEST(GltfWrite, ImagesKeepTheirBytesAndAreNoDataUris) {
  const TexturedMesh mesh = textured_sphere();
  const Glb glb = parse(encode_glb(mesh).value());
  const json& image = glb.header["images"][0];
  EXPECT_FALSE(image.contains("uri"));
  EXPECT_EQ(image["mimeType"], "image/png");
  const json& view = glb.header["bufferViews"][image["bufferView"].get<std::size_t>()];
  const std::string stored = glb.binary.substr(view.value("byteOffset", std::size_t{0}),
                                               view["byteLength"].get<std::size_t>());
  const auto& original = mesh.images[0].bytes;
  EXPECT_EQ(stored, std::string(original.begin(), original.end()));
}

TEST(GltfWrite, OnePrimitivePerMaterialInUseWithItsFactorsAndTextures) {
  TexturedMesh mesh = textured_sphere();
  mesh.images.push_back(mesh.images[0]);  // nothing refers to it
  Material& skin = mesh.materials[0];
  skin.base_color_factor = {0.5, 0.25, 1, 1};
  skin.base_color.wrap_s = 33071;
  skin.base_color.transform = TextureTransform{{0.5, 0.25}, 0.1, {2, 3}};
  mesh.materials.emplace_back().name = "unused";
  Material& horn = mesh.materials.emplace_back();
  horn.name = "horn";
  horn.roughness_factor = 0.5;
  for (int t = 0; t < 100; ++t) mesh.material[idx(t)] = 2;
  mesh.node_transform(0, 3) = 7;
  const Glb glb = parse(encode_glb(mesh).value());
  ASSERT_EQ(glb.header["meshes"][0]["primitives"].size(), 2u);
  ASSERT_EQ(glb.header["materials"].size(), 2u);
  EXPECT_EQ(glb.header["images"].size(), 1u);
  EXPECT_EQ(glb.header["materials"][1]["name"], "horn");
  EXPECT_EQ(glb.header["materials"][1]["pbrMetallicRoughness"]["roughnessFactor"], 0.5);
  const json& pbr = glb.header["materials"][0]["pbrMetallicRoughness"];
  EXPECT_EQ(pbr["baseColorFactor"][1], 0.25);
  EXPECT_EQ(pbr["baseColorTexture"]["extensions"]["KHR_texture_transform"]["scale"][1], 3);
  EXPECT_EQ(glb.header["extensionsUsed"], json::array({"KHR_texture_transform"}));
  EXPECT_EQ(glb.header["samplers"][0]["wrapS"], 33071);
  EXPECT_EQ(glb.header["nodes"][0]["matrix"][12], 7);  // column-major
  const json& horn_part = glb.header["meshes"][0]["primitives"][1];
  EXPECT_EQ(glb.header["accessors"][horn_part["indices"].get<std::size_t>()]["count"], 300);
}

TEST(GltfWrite, SeamsSplitVerticesAndNothingElse) {
  TexturedMesh mesh = textured_sphere();
  const VertexBuffer whole = weld_corners(mesh, 0);
  for (int k = 0; k < 3; ++k) mesh.uv_sets[0][idx(k)][0] += 1;  // one triangle becomes an island
  const VertexBuffer cut = weld_corners(mesh, 0);
  EXPECT_EQ(cut.positions.size(), whole.positions.size() + 3);
  EXPECT_EQ(cut.indices.size(), whole.indices.size());
}

TEST(GltfWrite, TangentsFollowIncreasingU) {
  // On the plane z = 0 with u = 2 x and v = -y (so that the image's up is +y): tangent +x, and the
  // bitangent cross(n, t) w = +y needs w = 1; mirrored u turns both.
  for (const double mirror : {1.0, -1.0}) {
    shapes::Surface plane = shapes::surface_of(shapes::grid(3));
    shapes::texture(
        plane, [&](int, const Vector3d& p) { return Vector2d(mirror * 2 * p[0], -p[1]); }, 64);
    plane.soup.materials[0].normal.image = 0;
    const TexturedMesh mesh =
        carry_texture(plane.view(), plane.view(), identity_map(plane.prepared.mesh))->mesh;
    const VertexBuffer buffer = weld_corners(mesh, 0, 0);
    ASSERT_EQ(buffer.tangents.size(), buffer.positions.size());
    for (const auto& t : buffer.tangents)
      EXPECT_EQ(t, (std::array<float, 4>{float(mirror), 0, 0, float(mirror)}));
    const Glb glb = parse(encode_glb(mesh).value());
    EXPECT_TRUE(glb.header["meshes"][0]["primitives"][0]["attributes"].contains("TANGENT"));
  }
}

TEST(GltfWrite, ManyVerticesGetWideIndices) {
  shapes::Surface plane = shapes::surface_of(shapes::grid(260));  // 261^2 > 65535 vertices
  const auto carried = carry_texture(plane.view(), plane.view(), identity_map(plane.prepared.mesh));
  const Glb glb = parse(encode_glb(carried->mesh).value());
  const json& primitive = glb.header["meshes"][0]["primitives"][0];
  EXPECT_EQ(glb.header["accessors"][primitive["indices"].get<std::size_t>()]["componentType"],
            5125);
  const auto indices = glb.values<std::uint32_t>(primitive["indices"]);
  EXPECT_EQ(*std::max_element(indices.begin(), indices.end()), 261u * 261u - 1);
}

TEST(GltfWrite, WhatCannotBeWrittenIsNamed) {
  TexturedMesh mesh = textured_sphere();
  mesh.images[0].mime_type = "";
  const auto foreign = encode_glb(mesh);
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::kOutput);
  EXPECT_EQ(foreign.error().message,
            "image \"texture.png\" is neither PNG nor JPEG: a GLB cannot hold it unchanged");
  EXPECT_EQ(encode_glb(TexturedMesh{}).error().message, "GLB: there is no triangle to write");
  mesh.uv_sets[0].pop_back();
  EXPECT_EQ(encode_glb(mesh).error().code, ErrorCode::kInternal);
}

}  // namespace
}  // namespace crosspatch
