#include "core/read_soup.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.hpp"
#include "mesh_files.hpp"
#include "shapes.hpp"
#include "temp_folder.hpp"

namespace crosspatch {
namespace {

PolygonSoup read(const TempFolder& folder, const std::string& name, const std::string& bytes) {
  auto soup = read_soup(folder.write(name, bytes));
  EXPECT_TRUE(soup) << soup.error().message;
  return soup.value_or(PolygonSoup{});
}

bool is_unset(const Vector2d& uv) {
  return std::isnan(uv[0]) && std::isnan(uv[1]);
}

TEST(ReadSoup, ObjOffAndPlyKeepNumbersAndEveryBitOfCoordinates) {
  const TriangleMesh mesh = shapes::icosphere(2);  // coordinates with 17 digits
  const TempFolder folder;
  const std::vector<std::pair<std::string, std::string>> variants{
      {"a.obj", files::obj(mesh.V, mesh.F)},
      {"a.off", files::off(mesh.V, mesh.F)},
      {"a.ply", files::ply_ascii(mesh.V, mesh.F)},
      {"b.ply", files::ply_binary(mesh.V, mesh.F, false)},
      {"c.PLY", files::ply_binary(mesh.V, mesh.F, true)}};
  for (const auto& [name, bytes] : variants) {
    const PolygonSoup soup = read(folder, name, bytes);
    ASSERT_EQ(soup.polygon_count(), mesh.face_count()) << name;
    EXPECT_EQ(soup.positions, mesh.V) << name;
    for (int c = 0; c < soup.corner_count(); ++c)
      ASSERT_EQ(soup.corner_vertex[idx(c)], mesh.F(c / 3, c % 3)) << name;
  }
}

TEST(ReadSoup, StlFacetsBringThreeVerticesEach) {
  const TriangleMesh mesh = shapes::tetrahedron();  // coordinates +-1, exact in single precision
  const TempFolder folder;
  for (const std::string& bytes :
       {files::stl_ascii(mesh.V, mesh.F), files::stl_binary(mesh.V, mesh.F)}) {
    const PolygonSoup soup = read(folder, "a.stl", bytes);
    ASSERT_EQ(soup.positions.rows(), 12);
    for (int c = 0; c < 12; ++c) {
      EXPECT_EQ(soup.corner_vertex[idx(c)], c);
      EXPECT_EQ(soup.positions.row(c), mesh.V.row(mesh.F(c / 3, c % 3)));
    }
  }
}

TEST(ReadSoup, BinaryStlMayBeginWithTheWordSolid) {
  const TriangleMesh mesh = shapes::tetrahedron();
  std::string bytes = files::stl_binary(mesh.V, mesh.F);
  bytes.replace(0, 5, "solid");
  EXPECT_EQ(read(TempFolder(), "a.stl", bytes).polygon_count(), 4);
}

TEST(ReadSoup, ObjIndicesCountFromOneOrBackFromTheLastLine) {
  const PolygonSoup soup = read(TempFolder(),
                                "a.obj",
                                "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\r\nv 1 1 0 # last\n"
                                "f 2 \\\n4 3\nf 1 1 2\nf 1 2\n#f 1 2 3\n");
  EXPECT_EQ(soup.corner_vertex, (std::vector<int>{0, 1, 2, 1, 3, 2, 0, 0, 1, 0, 1}));
  EXPECT_EQ(soup.polygon_begin, (std::vector<int>{0, 3, 6, 9, 11}));
  EXPECT_EQ(fan_triangle_corners(soup).size(), 9u);  // two corners make no triangle
}

TEST(ReadSoup, ObjSeamsKeepOneTextureCoordinateACorner) {
  const PolygonSoup soup =
      read(TempFolder(),
           "a.obj",
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0.25\nvt 0.5\nvn 0 0 2\n"
           "f 1/1/1 2/2/1 3/3/1\nf 2/1 4//1 3\n");
  ASSERT_EQ(soup.uv_sets.size(), 1u);
  const auto& uv = soup.uv_sets[0];
  EXPECT_EQ(uv[0], Vector2d(0, 1));  // v is turned
  EXPECT_EQ(uv[1], Vector2d(1, 0.75));
  EXPECT_EQ(uv[2], Vector2d(0.5, 1));  // v is 0 where it is not written
  EXPECT_EQ(uv[3], Vector2d(0, 1));
  EXPECT_TRUE(is_unset(uv[4]) && is_unset(uv[5]));
  EXPECT_EQ(soup.corner_normals[4], Vector3d(0, 0, 2));
  EXPECT_TRUE(std::isnan(soup.corner_normals[3][0]));
}

TEST(ReadSoup, MtlBecomesGltfMaterials) {
  const TempFolder folder;
  const std::string png = files::png_header(8, 4), jpeg = files::jpeg_header(8, 4);
  (void)folder.write("maps/skin one.png", png);
  (void)folder.write("n.jpg", jpeg);
  (void)folder.write("two words.mtl",
                     "newmtl skin\nKd 0 0 0\nmap_Kd -s 2 4 -o 0.5 0.25 -clamp on maps\\skin one.png"
                     "\nKd 0 0 0\nKe 0.5\nnorm -bm 0.75 n.jpg\nbump other.png\n"
                     "newmtl glass\nKd 0.1 0.2 0.3\nd 0.4\nPr 0.25\nPm 1\nmap_Kd gone.png\n"
                     "newmtl unused\nmap_Kd gone.png\n");
  const PolygonSoup soup =
      read(folder,
           "a.obj",
           "mtllib two words.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl glass\nf 1 2 3\n"
           "usemtl skin\nf 1 2 3\nusemtl glass\nf 1 2 3\n");
  EXPECT_EQ(soup.polygon_material, (std::vector<int>{-1, 0, 1, 0}));
  ASSERT_EQ(soup.materials.size(), 2u);
  const Material& skin = soup.materials[1];
  ASSERT_EQ(soup.images.size(), 2u);
  const ImageFile& image = soup.images[static_cast<std::size_t>(skin.base_color.image)];
  EXPECT_EQ(image.name, "skin one.png");
  EXPECT_EQ(std::string(image.bytes.begin(), image.bytes.end()), png);
  EXPECT_EQ(skin.base_color_factor, (std::array<double, 4>{1, 1, 1, 1}));
  EXPECT_EQ(skin.emissive_factor, (std::array<double, 3>{0.5, 0.5, 0.5}));
  EXPECT_EQ(skin.base_color.wrap_s, 33071);
  // With v upwards the map is v -> 4 v + 0.25; with v' = 1 - v downwards v' -> 4 v' - 3.25.
  EXPECT_EQ(skin.base_color.transform->offset, Vector2d(0.5, -3.25));
  EXPECT_EQ(skin.base_color.transform->scale, Vector2d(2, 4));
  EXPECT_EQ(soup.images[static_cast<std::size_t>(skin.normal.image)].mime_type, "image/jpeg");
  EXPECT_EQ(skin.normal.strength, 0.75);
  const Material& glass = soup.materials[0];
  EXPECT_EQ(glass.base_color.image, -1);
  EXPECT_EQ(glass.base_color_factor, (std::array<double, 4>{0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(glass.alpha_mode, "BLEND");
  EXPECT_EQ(glass.roughness_factor, 0.25);
  EXPECT_EQ(glass.metallic_factor, 1);
  EXPECT_EQ(soup.notes,
            (std::vector<std::string>{"image passed over: file name 'gone.png': no such file"}));
}

TEST(ReadSoup, NamesThatLeaveTheFolderArePassedOver) {
  const TempFolder folder;
  (void)folder.write("outside.mtl", "newmtl m\nKd 0.5 0 0\n");
  for (const std::string name :
       {"../outside.mtl", "in/../../outside.mtl", "/etc/passwd", "C:\\x.mtl", "file:///x", "."}) {
    const PolygonSoup soup = read(
        folder, "in/a.obj", "mtllib " + name + "\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    ASSERT_EQ(soup.notes.size(), 1u) << name;
    EXPECT_EQ(soup.materials[0].base_color_factor[0], 1) << name;
  }
  std::filesystem::create_symlink(folder.path() / "outside.mtl", folder.path() / "in/link.mtl");
  const PolygonSoup soup =
      read(folder, "in/a.obj", "mtllib link.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(soup.notes.size(), 1u);
}

TEST(ReadSoup, VertexColoursBecomeLinear) {
  const PolygonSoup obj =
      read(TempFolder(), "a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n");
  ASSERT_EQ(obj.corner_colors.size(), 3u);
  // IEC 61966-2-1: ((0.5 + 0.055) / 1.055)^2.4
  EXPECT_NEAR(obj.corner_colors[0][1], 0.2140, 1e-4);  // four digits cited
  EXPECT_EQ(obj.corner_colors[1], (std::array<float, 4>{1, 1, 1, 1}));
  const PolygonSoup ply =
      read(TempFolder(),
           "a.ply",
           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
           "float y\nproperty float z\nproperty uchar red\nproperty uchar "
           "green\nproperty uchar blue\nelement face 1\nproperty list uchar "
           "int vertex_index\nend_header\n0 0 0 255 0 0\n1 0 0 0 0 0\n"
           "0 1 0 0 0 255\n3 0 1 2\n");
  EXPECT_EQ(ply.corner_colors[0], (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_EQ(ply.corner_colors[2], (std::array<float, 4>{0, 0, 1, 1}));
}

TEST(ReadSoup, PlyCarriesCornerTextureCoordinatesAndTheirImage) {
  const TempFolder folder;
  (void)folder.write("t.png", files::png_header(2, 2));
  const PolygonSoup soup =
      read(folder,
           "a.ply",
           "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 4\nproperty float x\n"
           "property float y\nproperty float z\nelement face 2\nproperty list uchar int "
           "vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\nelement "
           "edge 1\nproperty int vertex1\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 "
           "0 1 1 0\n4 0 1 2 3 0 7\n0\n");
  ASSERT_EQ(soup.uv_sets.size(), 1u);
  EXPECT_EQ(soup.uv_sets[0][2], Vector2d(1, 0));  // v is turned
  EXPECT_TRUE(is_unset(soup.uv_sets[0][3]));
  EXPECT_EQ(soup.polygon_material, (std::vector<int>{0, -1}));
  EXPECT_EQ(soup.materials[0].base_color.image, 0);
}

TEST(ReadSoup, PlyVertexTextureCoordinatesReachTheCorners) {
  const PolygonSoup soup =
      read(TempFolder(),
           "a.ply",
           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
           "float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int "
           "vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0.25\n0 1 0 0 1\n3 2 1 0\n");
  EXPECT_EQ(soup.uv_sets[0][0], Vector2d(0, 0));
  EXPECT_EQ(soup.uv_sets[0][1], Vector2d(1, 0.75));
}

TEST(ReadSoup, OffPassesOverCommentsAndColours) {
  const PolygonSoup soup = read(TempFolder(),
                                "a.off",
                                "# a comment\n\nCOFF 4 2 0 # counts here\n\n0 0 0 255 0 0 1\n1 0 0 "
                                "0 0 0 1\n1 1 0 9 9 9 1\n0 1 0 1 1 1 1\n4 0 1 2 3 0.5 0.5 0.5\n"
                                "2 0 1\n");
  EXPECT_EQ(soup.polygon_begin, (std::vector<int>{0, 4, 6}));
  EXPECT_EQ(fan_triangle_corners(soup), (std::vector<int>{0, 1, 2, 0, 2, 3}));
}

TEST(ReadSoup, TheLimitsAreKept) {
  const TriangleMesh mesh = shapes::icosphere(1);  // 42 vertices, 80 triangles
  const TempFolder folder;
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"a.obj", files::obj(mesh.V, mesh.F)},
           {"a.off", files::off(mesh.V, mesh.F)},
           {"a.ply", files::ply_ascii(mesh.V, mesh.F)},
           {"a.stl", files::stl_ascii(mesh.V, mesh.F)},
           {"b.stl", files::stl_binary(mesh.V, mesh.F)}}) {
    const auto file = folder.write(name, bytes);
    EXPECT_TRUE(read_soup(file)) << name;
    EXPECT_FALSE(read_soup(file, {.max_triangles = 79})) << name;
    EXPECT_FALSE(read_soup(file, {.max_file_bytes = 100})) << name;
    EXPECT_FALSE(
        read_soup(file, {.max_triangles = name.ends_with("stl") ? 79 : 80, .max_vertices = 41}))
        << name;
  }
}

}  // namespace
}  // namespace crosspatch
