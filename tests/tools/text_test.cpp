// The small text formats and their building blocks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <tuple>

#include "program.hpp"
#include "shapes.hpp"
#include "tools/landmarks.hpp"
#include "tools/map_text.hpp"
#include "tools/output_files.hpp"
#include "tools/overlay_text.hpp"
#include "tools/point_map_text.hpp"
#include "tools/sha256.hpp"
#include "tools/text_lines.hpp"

namespace crosspatch {
namespace {

TEST(Sha256, GivesThePublishedDigests) {
  // FIPS 180-4 examples (NIST, "Cryptographic Standards and Guidelines: Example Values").
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(TextLines, KeepNumbersOfLinesThatSaySomething) {
  const auto lines = text_lines("# title\n\n a, b\tc # d\r\nlast");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].number, 3);
  EXPECT_THAT(lines[0].words, testing::ElementsAre("a", "b", "c"));
  EXPECT_EQ(lines[1].number, 4);
  int i = 7;
  EXPECT_FALSE(parse_number("12x", i));
  EXPECT_FALSE(parse_number("99999999999", i));
  EXPECT_EQ(i, 7);
  EXPECT_TRUE(parse_number("-12", i));
  EXPECT_EQ(i, -12);
}

TEST(MapText, ReadsBackEqual) {
  const std::vector<SurfacePoint> points = {
      {3, Vector3d(1.0 / 3, 1.0 / 7, 1 - 1.0 / 3 - 1.0 / 7)}, {}, {0, Vector3d(0, 1, 0)}};
  const auto read = parse_map(map_text(points), 3, 4);
  ASSERT_TRUE(read) << read.error().message;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ((*read)[i].face, points[i].face);
    EXPECT_EQ((*read)[i].bary, points[i].bary);
  }
}

/// A prepared mesh that is the file itself.
PreparedMesh unchanged(const TriangleMesh& mesh) {
  PreparedMesh prepared{mesh, {}, {}};
  for (int v = 0; v < mesh.vertex_count(); ++v) prepared.numbering.mesh_vertex.push_back(v);
  for (int f = 0; f < mesh.face_count(); ++f) {
    prepared.numbering.file_triangle.push_back(f);
    for (int k = 0; k < 3; ++k) {
      prepared.numbering.soup_corner.push_back(3 * f + k);
      prepared.numbering.triangle_corners.push_back(3 * f + k);
    }
  }
  return prepared;
}

TEST(MapText, IdentityMapsEachFileVertexToItself) {
  PreparedMesh mesh = unchanged(shapes::icosphere(1));
  mesh.numbering.mesh_vertex.push_back(-1);  // a vertex of the file that no triangle uses
  const auto points = map_of_file_vertices(identity_map(mesh.mesh), mesh, mesh);
  ASSERT_EQ(points.size(), 43u);
  for (int v = 0; v < 42; ++v) {
    const SurfacePoint& p = points[static_cast<std::size_t>(v)];
    EXPECT_LT((position(mesh.mesh, p) - mesh.mesh.position(v)).norm(), 1e-15);
  }
  EXPECT_FALSE(points.back().valid());
}

TEST(OverlayText, HasThePromisedLines) {
  const PreparedMesh mesh = unchanged(shapes::tetrahedron());
  const std::string text = overlay_text(identity_map(mesh.mesh), mesh, mesh);
  EXPECT_TRUE(text.starts_with("crosspatch-overlay 1\n4 4\n")) << text;
  const auto lines = text_lines(text);
  ASSERT_EQ(lines.size(), 10u);
  for (std::size_t i = 2; i < 6; ++i) EXPECT_EQ(lines[i].words.size(), 8u);
  for (std::size_t i = 6; i < 10; ++i) EXPECT_EQ(lines[i].words.size(), 6u);
}

TEST(OverlayText, ReadsBackAsABijection) {
  const PreparedMesh mesh = unchanged(shapes::icosphere(1));
  const SurfaceMap map = identity_map(mesh.mesh);
  const std::string text = overlay_text(map, mesh, mesh);
  EXPECT_TRUE(is_overlay_text(text));
  const auto read = parse_overlay(text, mesh, mesh);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(validate(*read, mesh.mesh, mesh.mesh));
  EXPECT_EQ(read->point_of_source_vertex, map.point_of_source_vertex);
  EXPECT_EQ(overlay_text(*read, mesh, mesh), text);
}

TEST(OverlayText, IsRefusedWithItsLine) {
  const PreparedMesh mesh = unchanged(shapes::tetrahedron());
  const std::string text = overlay_text(identity_map(mesh.mesh), mesh, mesh);
  const auto message = [&](const std::string& changed) {
    const auto map = parse_overlay(changed, mesh, mesh);
    return map ? std::string("read") : map.error().message;
  };
  EXPECT_EQ(message("crosspatch-overlay 2\n0 0\n"), "not an overlay of version 1");
  EXPECT_EQ(message("crosspatch-overlay 1\n4 5\n" + text.substr(text.find("4 4\n") + 4)),
            "8 lines for 4 points and 5 polygons");
  EXPECT_EQ(message("crosspatch-overlay 1\n1 0\n9 1 0 0 0 1 0 0\n"),
            "line 3: triangle 9 is no part of the mesh");
  EXPECT_EQ(message("crosspatch-overlay 1\n1 1\n0 1 0 0 0 1 0 0\n3 0 0 1 0 0\n"),
            "line 4: point 1 is outside [0, 1)");
}

TEST(PointMapText, BothFormsCountFromWhatIsSaid) {
  const PreparedMesh mesh = unchanged(shapes::tetrahedron());
  const auto vertices = parse_point_map("3\n-1 # none\n1\n0\n", 0, mesh, mesh);
  ASSERT_TRUE(vertices) << vertices.error().message;
  EXPECT_EQ(position(mesh.mesh, (*vertices)[0]), mesh.mesh.position(3));
  EXPECT_FALSE((*vertices)[1].valid());
  const auto from_one = parse_point_map("4\nNaN\n2\n1\n", 1, mesh, mesh);
  ASSERT_TRUE(from_one) << from_one.error().message;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ((*from_one)[i].face, (*vertices)[i].face);
    EXPECT_EQ((*from_one)[i].bary, (*vertices)[i].bary);
  }
  const auto points =
      parse_point_map("1 0.5 0.25 0.25\n4 1 0 0\n-1 0 0 0\n2,0,0,1\n", 1, mesh, mesh);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ((*points)[0].face, 0);
  EXPECT_EQ((*points)[0].bary, Vector3d(0.5, 0.25, 0.25));
  EXPECT_EQ((*points)[1].face, 3);
  EXPECT_FALSE((*points)[2].valid());
}

TEST(PointMapText, WeldedVerticesTakeTheFirstImage) {
  PreparedMesh mesh = unchanged(shapes::tetrahedron());
  mesh.numbering.mesh_vertex = {0, 0, 1, 2, 3, -1};
  const auto points =
      parse_point_map("-1\n2\n3\n4\n1\n5\n", 0, mesh, mesh);  // target vertices of the same file
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 4u);
  EXPECT_EQ(position(mesh.mesh, (*points)[0]), mesh.mesh.position(1));
  EXPECT_EQ(position(mesh.mesh, (*points)[3]), mesh.mesh.position(0));
}

TEST(PointMapText, IsRefusedWithItsLine) {
  const PreparedMesh mesh = unchanged(shapes::tetrahedron());
  for (const auto& [text, base, message] : std::vector<std::tuple<std::string, int, std::string>>{
           {"0\n1\n2\n", 0, "3 lines for the source's 4 vertices"},
           {"0\n1\n2\n3\n0\n", 0, "5 lines for the source's 4 vertices"},
           {"", 0, "0 lines for the source's 4 vertices"},
           {"0\n5\n2\n3\n", 0, "line 2: vertex 5 is outside [0, 4)"},
           {"1\n4\n2\n3\n", 0, "line 2: vertex 4 is outside [0, 4); --map-base 1 tells that"},
           {"1\n0\n2\n3\n", 1, "line 2: vertex 0 is outside [1, 5)"},
           {"1\n-2\n2\n3\n", 0, "line 2: vertex -2 is outside [0, 4)"},
           {"1\nx\n2\n3\n", 0, "line 2: 'x' is no vertex"},
           {"1\n0.5\n2\n3\n", 0, "line 2: '0.5' is no vertex"},
           {"1 2\n", 0, "line 1: 2 columns, neither 1 ('vertex') nor 4 ('face b0 b1 b2')"},
           {"1\n2 1 0 0\n", 0, "line 2: 4 columns, the first line has 1"},
           {"9 1 0 0\n", 0, "line 1: triangle 9 is outside [0, 4)"},
           {"0 1 0 z\n", 0, "line 1: not of the form 'face b0 b1 b2'"},
           {"0 1 1 0\n", 0, "line 1: barycentric coordinates sum to 2, not 1"},
           {"0 2 -1 0\n", 0, "line 1: barycentric coordinate -1 is negative"},
           {"0 nan 0 0\n", 0, "line 1: barycentric coordinates sum to nan, not 1"}}) {
    const auto points = parse_point_map(text, base, mesh, mesh);
    ASSERT_FALSE(points) << text;
    EXPECT_THAT(points.error().message, testing::HasSubstr(message));
    EXPECT_EQ(points.error().code, ErrorCode::kBadInput);
  }
}

TEST(Landmarks, AreReadWithComments) {
  const auto landmarks = parse_landmarks("# s t\n5 7\n 0\t2 # head\n", 6, 8);
  ASSERT_TRUE(landmarks) << landmarks.error().message;
  ASSERT_EQ(landmarks->size(), 2u);
  EXPECT_EQ((*landmarks)[0].source_vertex, 5);
  EXPECT_EQ((*landmarks)[1].target_vertex, 2);
  EXPECT_EQ(parse_landmarks("6 0\n", 6, 8).error().message,
            "line 1: source vertex 6 is outside [0, 6)");
  EXPECT_FALSE(parse_landmarks("1 2 3\n", 6, 8));
  EXPECT_FALSE(parse_landmarks("1.5 2\n", 6, 8));
}

using OutputFiles = test::Program;

TEST_F(OutputFiles, AreWrittenAllOrNone) {
  const std::string one = folder / "out/one", two = folder / "out/two";
  std::filesystem::create_directories(folder / "out/folder/inner");
  const std::string blocked = folder / "out/folder";  // a file cannot replace a folder
  EXPECT_TRUE(check_output_paths({one, two}));
  EXPECT_EQ(check_output_paths({one, blocked}).error().code, ErrorCode::kOutput);
  EXPECT_FALSE(write_output_files({{folder / "gone/one", "1"}, {two, "2"}}));
  EXPECT_THAT(written(), testing::ElementsAre("folder"));
  EXPECT_FALSE(write_output_files({{blocked, "1"}, {two, "2"}}));
  EXPECT_THAT(written(), testing::ElementsAre("folder"));
  EXPECT_TRUE(write_output_files({{one, "1"}, {two, std::string("2\0", 2)}}));
  EXPECT_EQ(test::read_text(one), "1");
  EXPECT_EQ(test::read_text(two), std::string("2\0", 2));
  EXPECT_THAT(written(), testing::ElementsAre("folder", "one", "two"));
}

}  // namespace
}  // namespace crosspatch
