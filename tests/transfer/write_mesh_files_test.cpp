#include "transfer/write_mesh_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "shapes.hpp"
#include "transfer/carry_texture.hpp"
#include "transfer/painted.hpp"
#include "transfer/read_mesh_file.hpp"

namespace crosspatch {
namespace {

/// A sphere with a seam, an image and an odd name, as it is written.
TexturedMesh example() {
  shapes::Surface s = shapes::surface_of(shapes::icosphere(1));
  shapes::texture(
      s, [](int f, const Vector3d& p) { return Vector2d(0.1 * (f % 7), 0.5 + 0.4 * p[2]); }, 4);
  s.soup.images = {
      shapes::png(4, 3, [](double u, double v) { return Eigen::Array4d(u, v, 0.25, 1); })};
  s.soup.images[0].name = "my hide #1.jpeg";  // neither its type nor fit for a URI
  s.soup.node_transform.topRightCorner<3, 1>() = Vector3d(1, 2, 3);
  auto carried = carry_texture(s.view(), s.view(), identity_map(s.prepared.mesh));
  EXPECT_TRUE(carried) << carried.error().message;
  return carried->mesh;
}

class MeshFiles : public testing::TestWithParam<const char*> {
 protected:
  MeshFiles() : folder_(std::filesystem::path(testing::TempDir()) / "mesh files") {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~MeshFiles() override { std::filesystem::remove_all(folder_); }

  void write(const std::vector<NamedBytes>& files) const {
    for (const NamedBytes& file : files)
      std::ofstream(folder_ / file.name, std::ios::binary) << file.bytes;
  }

  std::filesystem::path folder_;
};

TEST_P(MeshFiles, ReadBackEqual) {
  const TexturedMesh mesh = example();
  const auto files = encode_mesh_files(mesh, GetParam());
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_EQ(files->front().name, GetParam());
  write(*files);
  const auto soup = read_mesh_file(folder_ / GetParam());
  ASSERT_TRUE(soup) << soup.error().message;
  ASSERT_EQ(soup->polygon_count(), mesh.triangle_count());
  const bool applied = soup->node_transform.isIdentity(0);
  const Vector3d shift = applied ? Vector3d(1, 2, 3) : Vector3d(0, 0, 0);
  for (int c = 0; c < soup->corner_count(); ++c) {
    const Vector3d p = soup->positions.row(soup->corner_vertex[idx(c)]).transpose();
    const Vector3d expected = mesh.positions.row(mesh.triangles(c / 3, c % 3)).transpose() + shift;
    EXPECT_LT((p - expected).norm(), 1e-6) << c;  // single precision in glTF and PLY
    if (soup->uv_sets.empty()) continue;
    EXPECT_LT((soup->uv_sets[0][idx(c)] - mesh.uv_sets[0][idx(c)]).norm(), 1e-6) << c;
  }
  if (mesh_format(GetParam()) == MeshFormat::kPly) {
    ASSERT_FALSE(soup->corner_colors.empty());
    return;
  }
  ASSERT_EQ(soup->images.size(), 1u);
  EXPECT_EQ(soup->images[0].bytes, mesh.images[0].bytes);
}

INSTANTIATE_TEST_SUITE_P(Formats,
                         MeshFiles,
                         testing::Values("a ball.glb", "a ball.gltf", "ball.OBJ", "ball.ply"));

TEST(MeshFormats, AreToldByTheExtension) {
  EXPECT_EQ(mesh_format("x/y.GLB"), MeshFormat::kGlb);
  EXPECT_FALSE(mesh_format("y.fbx"));
  EXPECT_EQ(encode_mesh_files(example(), "y.fbx").error().message,
            "'y.fbx' is no .glb, .gltf, .obj or .ply");
}

}  // namespace
}  // namespace crosspatch
