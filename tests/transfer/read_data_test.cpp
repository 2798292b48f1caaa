#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "core/prepare.hpp"
#include "data_folder.hpp"
#include "transfer/read_mesh_file.hpp"

namespace crosspatch {
namespace {

using Row = std::map<std::string, std::string>;

/// Rows of mesh_stats.csv, what an independent checker measured of every mesh.
std::vector<Row> mesh_stats(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line, cell;
  std::getline(in, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    Row row;
    std::istringstream cells(line);
    for (const std::string& name : names) row[name] = std::getline(cells, cell, ',') ? cell : "";
    rows.push_back(row);
  }
  return rows;
}

class ReadData : public testing::Test {
 protected:
  void SetUp() override {
    const auto folder = data_folder();
    if (!folder) GTEST_SKIP() << "no data folder: set CROSSPATCH_DATA";
    folder_ = *folder;
    rows_ = mesh_stats(folder_ / "mesh_stats.csv");
    ASSERT_GT(rows_.size(), 100u);
  }

  std::filesystem::path folder_;
  std::vector<Row> rows_;
};

TEST_F(ReadData, CountsAgreeWithTheIndependentChecker) {
  for (const Row& row : rows_) {
    const std::string& path = row.at("path");
    const auto soup = read_mesh_file(folder_ / path);
    ASSERT_TRUE(soup) << soup.error().message;
    EXPECT_EQ(fan_triangle_corners(*soup).size(), std::stoul(row.at("F")) * 3) << path;
    // The checker's counts of glTF are after welding.
    EXPECT_TRUE(!row.at("welded").empty() || soup->positions.rows() == std::stol(row.at("V")))
        << path;
    EXPECT_EQ(!soup->uv_sets.empty(), row.at("uv") == "True") << path;
  }
}

TEST_F(ReadData, EveryMeshIsPreparedAndCleanOnesKeepTheirNumbers) {
  int clean_meshes = 0;
  for (const Row& row : rows_) {
    const std::string& path = row.at("path");
    const auto soup = read_mesh_file(folder_ / path);
    ASSERT_TRUE(soup) << soup.error().message;
    const auto prepared = prepare(*soup);
    ASSERT_TRUE(prepared) << path << ": " << prepared.error().message;
    const TriangleMesh& mesh = prepared->mesh;
    EXPECT_TRUE(validate(mesh)) << path << ": " << validate(mesh).error().message;
    const bool clean = row.at("manifold") == "True" && row.at("orient") == "True" &&
                       row.at("closed") == "True" && row.at("comp") == "1" && row.at("iso") == "0";
    if (!clean) continue;
    ++clean_meshes;
    EXPECT_EQ(mesh.vertex_count(), std::stoi(row.at("V"))) << path;
    EXPECT_EQ(mesh.face_count(), std::stoi(row.at("F"))) << path;
    EXPECT_EQ(genus(mesh), static_cast<int>(std::stod(row.at("genus")))) << path;
    EXPECT_TRUE(boundary_loops(mesh).empty()) << path;
    if (!row.at("welded").empty()) continue;
    for (int v = 0; v < mesh.vertex_count(); ++v)
      ASSERT_EQ(prepared->numbering.mesh_vertex[static_cast<std::size_t>(v)], v) << path;
    for (int f = 0; f < mesh.face_count(); ++f)
      ASSERT_EQ(prepared->numbering.file_triangle[static_cast<std::size_t>(f)], f) << path;
  }
  EXPECT_GT(clean_meshes, 100);
}

TEST_F(ReadData, EveryBrokenFileIsRepairedInWordsOrClean) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "broken")) {
    const auto soup = read_mesh_file(entry.path());
    ASSERT_TRUE(soup) << soup.error().message;
    const auto prepared = prepare(*soup);
    ASSERT_TRUE(prepared) << prepared.error().message;
    // One is whole, the other a clean surface with holes.
    const bool clean = entry.path().filename() == "hand_small.off" ||
                       entry.path().filename() == "elephant_with_holes.off";
    EXPECT_EQ(prepared->repairs.empty(), clean) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 0);
}

TEST_F(ReadData, TexturesComeAsTheFilesTheyAre) {
  const auto spot = read_mesh_file(folder_ / "textured/spot.obj");
  ASSERT_TRUE(spot) << spot.error().message;
  ASSERT_EQ(spot->images.size(), 1u);
  EXPECT_EQ(spot->images[0].bytes.size(),
            std::filesystem::file_size(folder_ / "textured/spot_texture.png"));
  EXPECT_EQ(spot->materials.at(0).base_color.image, 0);
  const auto fox = read_mesh_file(folder_ / "textured/Fox.glb");
  ASSERT_TRUE(fox) << fox.error().message;
  ASSERT_EQ(fox->images.size(), 1u);
  EXPECT_EQ(fox->images[0].mime_type, "image/png");
  EXPECT_EQ(fox->positions.rows(), 1728);  // accessor 0 of the file
}

}  // namespace
}  // namespace crosspatch
