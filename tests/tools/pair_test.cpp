// Drives the built program: features and maps of two surfaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/creatures.hpp"
#include "pair_of_surfaces.hpp"
#include "shapes.hpp"
#include "tools/map_text.hpp"
#include "tools/text_lines.hpp"
#include "tools/viewer.hpp"

namespace crosspatch {
namespace {

using test::PairOfSurfaces;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(PairOfSurfaces, MapWritesAllItsFiles) {
  const test::Outcome done =
      run("map source.obj target.off --landmarks pairs.txt --output out/map.txt --inverse "
          "out/inverse.txt --overlay out/overlay.txt --json out/report.json");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(written(), ElementsAre("inverse.txt", "map.txt", "overlay.txt", "report.json"));
  const TriangleMesh mesh = shapes::icosphere(3);
  for (const char* name : {"map.txt", "inverse.txt"}) {
    const auto map =
        parse_map(test::read_text(folder / "out" / name), mesh.vertex_count(), mesh.face_count());
    ASSERT_TRUE(map) << map.error().message;
    for (int v = 0; v < 4; ++v) {  // landmarks are met exactly
      const SurfacePoint& p = (*map)[static_cast<std::size_t>(v)];
      int corner = 0;
      EXPECT_EQ(p.bary.maxCoeff(&corner), 1);
      EXPECT_EQ(mesh.F(p.face, corner), v);
    }
  }
  EXPECT_TRUE(test::read_text(folder / "out/overlay.txt").starts_with("crosspatch-overlay 1\n"));
  const auto report = nlohmann::json::parse(test::read_text(folder / "out/report.json"));
  EXPECT_EQ(report["inputs"].size(), 3u);
  EXPECT_EQ(report["inputs"][0]["role"], "source");
  EXPECT_EQ(report["quality"]["flipped_triangles"], 0);
  EXPECT_NEAR(report["quality"]["coverage"].get<double>(), 1, 1e-9);
  EXPECT_GE(report["quality"]["symmetric_dirichlet_median"].get<double>(), 4 - 1e-9);
  EXPECT_EQ(report["outputs"].size(), 3u);
  EXPECT_GE(report["stages"].size(), 4u);
}

TEST_F(PairOfSurfaces, ReportIsOnePageWithBothMaps) {
  if (viewer_script().empty()) GTEST_SKIP() << "this build has no viewer";
  ASSERT_EQ(
      run("map source.obj target.off -q -o out/map --report out/page.html --json out/j").exit_code,
      0);
  const std::string page = test::read_text(folder / "out/page.html");
  const std::string begin = "<script id=\"data\" type=\"application/json\">";
  const std::size_t at = page.find(begin);
  ASSERT_NE(at, std::string::npos);
  const std::size_t first = at + begin.size(), end = page.find("</script>", first);
  const auto data = nlohmann::json::parse(page.substr(first, end - first));
  const auto report = nlohmann::json::parse(test::read_text(folder / "out/j"));
  EXPECT_EQ(data["maps"][0]["name"], "chosen");
  EXPECT_EQ(data["maps"].size(), report["quality"].contains("margin_2") ? 2u : 1u);
  EXPECT_EQ(data["graphs"]["source"]["nodes"].size() % 2, 0u);  // Euler's characteristic is even
  EXPECT_FALSE(data["figures"].empty());
  for (const char* fetching : {"<script src", "<link", "<img"})
    EXPECT_EQ(page.find(fetching), std::string::npos) << fetching;
}

TEST_F(PairOfSurfaces, AlternativesGetNumberedNames) {
  ASSERT_EQ(
      run("map source.obj target.off -q -o out/m.txt --alternatives 2 --json out/j").exit_code, 0);
  const auto report = nlohmann::json::parse(test::read_text(folder / "out/j"));
  const bool another = report["quality"].contains("margin_2");
  EXPECT_EQ(std::filesystem::exists(folder / "out/m_2.txt"), another);
  if (another) {
    EXPECT_NE(test::read_text(folder / "out/m.txt"), test::read_text(folder / "out/m_2.txt"));
    EXPECT_GE(report["quality"]["margin_2"].get<double>(),
              report["quality"]["margin"].get<double>());
  }
}

TEST_F(PairOfSurfaces, ConfigurationIsPrintedAndReadBack) {
  const test::Outcome printed =
      run("transfer source.obj target.off -o out/a.glb --size 32 --mode bake -q --print-config");
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(printed.out, testing::HasSubstr("[transfer]\n"));
  EXPECT_THAT(printed.out, testing::HasSubstr("size=32"));
  EXPECT_THAT(written(), testing::IsEmpty());
  test::write_text(folder / "c.toml", printed.out);
  EXPECT_EQ(run("transfer --config c.toml").exit_code, 0);
  EXPECT_THAT(written(), testing::ElementsAre("a.glb"));
  // The command line has the last word.
  EXPECT_EQ(run("transfer --config c.toml -o out/b.glb").exit_code, 0);
  EXPECT_THAT(written(), testing::UnorderedElementsAre("a.glb", "b.glb"));
  test::write_text(folder / "wrong.toml", "[transfer]\nsiez=32\n");
  const test::Outcome wrong =
      run("transfer source.obj target.off -o out/c.glb --config wrong.toml");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, testing::HasSubstr("transfer.siez"));
}

TEST_F(PairOfSurfaces, ATableHasNoLeftAndItIsSaid) {
  // Turned round by half a turn it is the same, and no map tells which way round is right.
  const Vector3d none = Vector3d::Zero(), leg(1.2, 0.7, -1.3);
  const std::array<Vector3d, 6> legs{leg,
                                     Vector3d(leg.x(), -leg.y(), leg.z()),
                                     Vector3d(-leg.x(), leg.y(), leg.z()),
                                     Vector3d(-leg.x(), -leg.y(), leg.z()),
                                     none,
                                     none};
  write_obj("table.obj", shapes::creature(2, 1, legs));
  write_obj("other.obj", shapes::creature(3, 1, legs));
  const test::Outcome unsure = run("map table.obj other.obj -q -o out/map.txt");
  ASSERT_EQ(unsure.exit_code, 0) << unsure.err;
  EXPECT_THAT(unsure.err, HasSubstr("the two are symmetric: another map fits as well"));
}

TEST_F(PairOfSurfaces, MatchesNameVerticesOfBothFilesOnce) {
  for (const std::string method : {"default", "paper"}) {
    const test::Outcome done =
        run("match source.obj target.off --output out/matches.csv --method " + method);
    ASSERT_EQ(done.exit_code, 0) << done.err;
    const std::string csv = test::read_text(folder / "out/matches.csv");
    EXPECT_TRUE(csv.starts_with("kind,source_vertex,target_vertex,confidence\n"));
    const auto lines = text_lines(csv);
    EXPECT_GE(lines.size(), 3u) << method;
    std::set<std::pair<std::string_view, int>> sources, targets;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const auto& words = lines[i].words;
      ASSERT_EQ(words.size(), 4u);
      EXPECT_THAT(words[0], testing::AnyOf("max", "saddle", "min"));
      int source = -1, target = -1;
      double confidence = -1;
      ASSERT_TRUE(parse_number(words[1], source) && parse_number(words[2], target) &&
                  parse_number(words[3], confidence));
      EXPECT_TRUE(source >= 0 && source < 642 && target >= 0 && target < 642);
      EXPECT_TRUE(confidence >= 0 && confidence <= 1);
      EXPECT_TRUE(sources.insert({words[0], source}).second) << "matched once with one kind";
      EXPECT_TRUE(targets.insert({words[0], target}).second);
    }
  }
}

TEST_F(PairOfSurfaces, HandlesOfOneSurfaceOnlyAreCutAndTold) {
  write_off("torus.off", shapes::torus(2, 0.7, 20, 10));
  const std::string told = "1 handle of the source and nothing of the target were cut";
  const test::Outcome done = run(
      "map torus.off target.off --output out/map.txt --json out/map.json --overlay out/overlay");
  EXPECT_THAT(done.err, HasSubstr(told));
  const auto quality = nlohmann::json::parse(test::read_text(folder / "out/map.json"))["quality"];
  EXPECT_EQ(quality["flipped_triangles"].get<int>(), 0);
  const test::Outcome again =
      run("transfer torus.off target.off --map out/overlay --texture position --output out/a.glb");
  EXPECT_EQ(again.exit_code, done.exit_code) << again.err;
  EXPECT_THAT(again.err, HasSubstr(told));
}

TEST_F(PairOfSurfaces, HandlesOfBothAreMappedWhole) {
  write_off("torus.off", shapes::torus(2, 0.7, 20, 10));
  const test::Outcome done =
      run("map torus.off torus.off --output out/map.txt --json out/map.json --overlay out/overlay");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.err, Not(HasSubstr("cut for the map")));
  const auto quality = nlohmann::json::parse(test::read_text(folder / "out/map.json"))["quality"];
  EXPECT_EQ(quality["flipped_triangles"].get<int>(), 0);
  EXPECT_NEAR(quality["coverage"].get<double>(), 1, 1e-9);
  const test::Outcome again =
      run("transfer torus.off torus.off --map out/overlay --texture position --output out/a.glb");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("cut for the map")));
}

TEST_F(PairOfSurfaces, BadLandmarksEndWithThree) {
  write("bad.txt", "0 0\n1 642\n");
  expect_error("map source.obj target.off --landmarks bad.txt --output out/map.txt",
               3,
               "bad.txt: line 2: target vertex 642 is outside [0, 642)");
}

}  // namespace
}  // namespace crosspatch
