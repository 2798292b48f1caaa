#include "transfer/gltf_read.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/index.hpp"
#include "core/prepare.hpp"
#include "gltf_files.hpp"
#include "shapes.hpp"
#include "temp_folder.hpp"
#include "transfer/read_mesh_file.hpp"

namespace crosspatch {
namespace {

using nlohmann::json;
using testing::HasSubstr;

PolygonSoup read(const files::Gltf& gltf) {
  const TempFolder folder;
  auto soup = read_mesh_file(folder.write("a.glb", gltf.glb()));
  EXPECT_TRUE(soup) << soup.error().message;
  return soup.value_or(PolygonSoup{});
}

std::string error_of(const files::Gltf& gltf) {
  const TempFolder folder;
  const auto soup = read_gltf(folder.write("a.glb", gltf.glb()));
  return soup ? "accepted" : soup.error().message;
}

files::Gltf tetrahedron() {
  const TriangleMesh mesh = shapes::tetrahedron();
  return files::gltf(mesh.V, mesh.F);
}

TEST(GltfRead, PositionsTexturesAndMaterialsAreRead) {
  const TriangleMesh mesh = shapes::tetrahedron();  // +-1, exact in single precision
  files::Gltf gltf = tetrahedron();
  gltf.json["materials"][0]["pbrMetallicRoughness"] = {
      {"baseColorFactor", {0.5, 0.25, 1, 0.75}},
      {"metallicFactor", 0.125},
      {"roughnessFactor", 0.5},
      {"baseColorTexture",
       {{"index", 0},
        {"extensions",
         {{"KHR_texture_transform",
           {{"offset", {0.5, 0.25}}, {"rotation", 1.5}, {"scale", {2, 3}}, {"texCoord", 0}}}}}}}};
  gltf.json["materials"][0]["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  gltf.json["materials"][0]["alphaMode"] = "MASK";
  gltf.json["materials"][0]["doubleSided"] = true;
  const PolygonSoup soup = read(gltf);
  EXPECT_EQ(soup.positions, mesh.V);
  for (int c = 0; c < 12; ++c) EXPECT_EQ(soup.corner_vertex[idx(c)], mesh.F(c / 3, c % 3));
  ASSERT_EQ(soup.uv_sets.size(), 1u);
  for (int c = 0; c < 12; ++c)
    EXPECT_EQ(soup.uv_sets[0][idx(c)],
              Vector2d(mesh.V(mesh.F(c / 3, c % 3), 0), mesh.V(mesh.F(c / 3, c % 3), 1)));
  ASSERT_EQ(soup.images.size(), 1u);
  EXPECT_EQ(soup.images[0].name, "skin");
  EXPECT_EQ(soup.images[0].mime_type, "image/png");
  const std::string png = files::png_header(4, 4);
  EXPECT_EQ(std::string(soup.images[0].bytes.begin(), soup.images[0].bytes.end()), png);
  ASSERT_EQ(soup.materials.size(), 1u);
  const Material& m = soup.materials[0];
  EXPECT_EQ(m.base_color_factor, (std::array<double, 4>{0.5, 0.25, 1, 0.75}));
  EXPECT_EQ(m.metallic_factor, 0.125);
  EXPECT_EQ(m.roughness_factor, 0.5);
  EXPECT_EQ(m.alpha_mode, "MASK");
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.base_color.image, 0);
  EXPECT_EQ(m.base_color.wrap_s, 33071);
  EXPECT_EQ(m.base_color.wrap_t, 10497);
  EXPECT_EQ(m.base_color.mag_filter, 9728);
  ASSERT_TRUE(m.base_color.transform);
  EXPECT_EQ(m.base_color.transform->offset, Vector2d(0.5, 0.25));
  EXPECT_EQ(m.base_color.transform->rotation_radians, 1.5);
  EXPECT_EQ(m.base_color.transform->scale, Vector2d(2, 3));
  EXPECT_EQ(m.normal.strength, 0.5);
  EXPECT_EQ(m.emissive.image, -1);
}

TEST(GltfRead, FactorsThatAreNotWrittenAreThoseOfTheFormat) {
  files::Gltf gltf = tetrahedron();
  gltf.json["materials"][0] = json::object();
  const Material m = read(gltf).materials.at(0);
  EXPECT_EQ(m.base_color_factor, (std::array<double, 4>{1, 1, 1, 1}));
  EXPECT_EQ(m.metallic_factor, 1);
  EXPECT_EQ(m.roughness_factor, 1);
  EXPECT_EQ(m.alpha_mode, "OPAQUE");
}

TEST(GltfRead, StripsAndFansListTheirTrianglesAsSpecified) {
  MatrixX3d V(5, 3);
  V << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0;
  MatrixX3i F(1, 3);
  F << 0, 1, 2;
  files::Gltf gltf = files::gltf(V, F);
  gltf.json["meshes"][0]["primitives"][0].erase("indices");
  gltf.json["meshes"][0]["primitives"][0]["mode"] = 5;
  EXPECT_EQ(read(gltf).corner_vertex, (std::vector<int>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  gltf.json["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_EQ(read(gltf).corner_vertex, (std::vector<int>{1, 2, 0, 2, 3, 0, 3, 4, 0}));
  gltf.json["meshes"][0]["primitives"][0]["mode"] = 1;
  EXPECT_THAT(error_of(gltf), HasSubstr("holds no triangles"));
}

TEST(GltfRead, FurtherNodesAreBroughtToTheFirst) {
  const TriangleMesh mesh = shapes::tetrahedron();
  files::Gltf gltf = tetrahedron();
  gltf.json["nodes"] = {{{"mesh", 0}, {"translation", {1, 2, 3}}, {"scale", {2, 2, 2}}},
                        {{"children", {2}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}},
                        {{"mesh", 0}, {"scale", {-1, 1, 1}}},
                        {{"mesh", 0}}};
  gltf.json["scenes"][0]["nodes"] = {1, 0};  // the order of the file counts, not the scene's
  const PolygonSoup soup = read(gltf);
  ASSERT_EQ(soup.positions.rows(), 8);  // node 3 is not in the scene
  EXPECT_EQ(soup.positions.topRows(4), mesh.V);
  for (int v = 0; v < 4; ++v) {
    const Eigen::Vector4d shown =
        soup.node_transform * soup.positions.row(v + 4).transpose().homogeneous();
    // Mirrored in x, then a quarter turn about z: (x, y) -> (-x, y) -> (-y, -x).
    const Vector3d expected(-mesh.V(v, 1), -mesh.V(v, 0), mesh.V(v, 2));
    EXPECT_LT((shown.head<3>() - expected).norm(), 1e-12);  // rounding
  }
  // The mirrored one keeps its outside.
  const auto second = prepare(soup);
  ASSERT_TRUE(second);
  EXPECT_THAT(second->repairs, testing::Not(testing::Contains(HasSubstr("volume"))));
  EXPECT_EQ(soup.corner_vertex[13], 4 + mesh.F(0, 2));
}

TEST(GltfRead, SparseAccessorsReplaceElements) {
  files::Gltf gltf = tetrahedron();
  const int indices = gltf.add_view(std::string("\x02", 1));
  const int values = gltf.add_view(files::floats({7, 8, 9}));
  gltf.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(read(gltf).positions.row(2), Eigen::RowVector3d(7, 8, 9));
  gltf.json["accessors"][0].erase("bufferView");
  const PolygonSoup soup = read(gltf);
  EXPECT_EQ(soup.positions.row(2), Eigen::RowVector3d(7, 8, 9));
  EXPECT_EQ(soup.positions.row(1), Eigen::RowVector3d(0, 0, 0));
}

TEST(GltfRead, StridesAndNormalizedIntegersAreUnderstood) {
  files::Gltf gltf = tetrahedron();
  std::string uv, color;
  for (int v = 0; v < 4; ++v) {
    uv += files::bytes_of(static_cast<std::uint16_t>(65535 * (v % 2))) +
          files::bytes_of(std::uint16_t{0}) + "junk";
    color += std::string("\xff\x00\x33\x00", 4);
  }
  gltf.json["accessors"][1] = {{"bufferView", gltf.add_view(uv)},
                               {"componentType", 5123},
                               {"normalized", true},
                               {"type", "VEC2"},
                               {"count", 4}};
  gltf.json["bufferViews"].back()["byteStride"] = 8;
  const int c = gltf.add_accessor(color, 5121, "VEC3", 4);
  gltf.json["accessors"][idx(c)]["normalized"] = true;
  gltf.json["bufferViews"].back()["byteStride"] = 4;
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = c;
  const PolygonSoup soup = read(gltf);
  for (int k = 0; k < 12; ++k) {
    EXPECT_EQ(soup.uv_sets[0][idx(k)], Vector2d(soup.corner_vertex[idx(k)] % 2, 0));
    EXPECT_EQ(soup.corner_colors[idx(k)], (std::array<float, 4>{1, 0, 0.2f, 1}));
  }
}

TEST(GltfRead, AttributesAPrimitiveLacksAreUnset) {
  files::Gltf gltf = tetrahedron();
  json& primitives = gltf.json["meshes"][0]["primitives"];
  json bare = primitives[0];
  bare["attributes"].erase("TEXCOORD_0");
  bare.erase("material");
  primitives = {bare, primitives[0], bare};
  const PolygonSoup soup = read(gltf);
  ASSERT_EQ(soup.polygon_count(), 12);
  EXPECT_EQ(soup.positions.rows(), 12);
  EXPECT_EQ(soup.polygon_material[3], -1);
  EXPECT_EQ(soup.polygon_material[4], 0);
  EXPECT_TRUE(std::isnan(soup.uv_sets[0][0][0]));
  EXPECT_FALSE(std::isnan(soup.uv_sets[0][12][0]));
  EXPECT_TRUE(std::isnan(soup.uv_sets[0][35][0]));
}

TEST(GltfRead, FilesBesideItAreReadAndNoOthers) {
  const TempFolder folder;
  files::Gltf gltf = tetrahedron();
  (void)folder.write("in/data one.bin", gltf.binary);
  (void)folder.write("in/maps/a.png", files::png_header(3, 3));
  (void)folder.write("data.bin", gltf.binary);
  (void)folder.write("b.png", files::png_header(3, 3));
  gltf.json["buffers"][0]["uri"] = "data%20one.bin";
  gltf.json["images"][0] = {{"uri", "maps/a.png"}};
  const auto soup = read_gltf(folder.write("in/a.gltf", gltf.json.dump()));
  ASSERT_TRUE(soup) << soup.error().message;
  EXPECT_EQ(soup->images.at(0).name, "a.png");
  EXPECT_TRUE(soup->notes.empty());
  for (const char* uri : {"../b.png",
                          "%2e%2e/b.png",
                          "/etc/passwd",
                          ".",
                          "",
                          "http://x/y.png",
                          "file:///etc/passwd",
                          "~/x.png",
                          "$HOME/x.png"}) {
    gltf.json["images"][0] = {{"uri", uri}};
    const auto without = read_gltf(folder.write("in/a.gltf", gltf.json.dump()));
    if (without) {
      EXPECT_TRUE(without->images.empty()) << uri;
      EXPECT_EQ(without->materials.at(0).base_color.image, -1) << uri;
      EXPECT_FALSE(without->notes.empty()) << uri;
    }
  }
  gltf.json.erase("images");
  gltf.json.erase("textures");
  gltf.json.erase("materials");
  gltf.json["meshes"][0]["primitives"][0].erase("material");
  for (const char* uri : {"../data.bin", "..\\data.bin", "/etc/passwd", ".", "gone.bin"}) {
    gltf.json["buffers"][0]["uri"] = uri;
    EXPECT_FALSE(read_gltf(folder.write("in/a.gltf", gltf.json.dump()))) << uri;
  }
}

TEST(GltfRead, DataUrisAreDecoded) {
  files::Gltf gltf = tetrahedron();
  gltf.json["images"][0] = {
      {"uri",
       "data:image/"
       "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhg"
       "GAWjR9awAAAABJRU5ErkJggg=="}};
  const PolygonSoup soup = read(gltf);
  EXPECT_EQ(soup.images.at(0).mime_type, "image/png");
  EXPECT_EQ(soup.images.at(0).bytes.size(), 70u);
}

TEST(GltfRead, WhatCannotBeUsedIsNamed) {
  const auto with = [](auto change) {
    files::Gltf gltf = tetrahedron();
    change(gltf.json);
    return error_of(gltf);
  };
  EXPECT_THAT(with([](json& j) { j["accessors"][0]["bufferView"] = 99; }),
              HasSubstr("accessors 0: index 99 into bufferViews is outside [0, 4)"));
  EXPECT_THAT(with([](json& j) { j["accessors"][0]["count"] = 4000000000u; }),
              HasSubstr("4000000000 elements, at most 60000000 are read"));
  EXPECT_THAT(with([](json& j) { j["accessors"][0]["count"] = 5; }),
              HasSubstr("5 elements of 12 bytes from byte 0 do not fit buffer view 0 of 48"));
  EXPECT_THAT(with([](json& j) { j["bufferViews"][3]["buffer"] = 7; }),
              HasSubstr("bufferViews 3: index 7 into buffers"));
  EXPECT_THAT(with([](json& j) { j["bufferViews"][3]["byteLength"] = 1 << 30; }),
              HasSubstr("outside the buffer's"));
  EXPECT_THAT(with([](json& j) { j["nodes"][0]["children"] = {0}; }),
              HasSubstr("node 0: has two parents or is its own ancestor"));
  EXPECT_THAT(with([](json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }),
              HasSubstr("the file needs extension 'KHR_draco_mesh_compression'"));
}

}  // namespace
}  // namespace crosspatch
