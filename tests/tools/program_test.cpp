// Drives the built program.
#include "program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "shapes.hpp"
#include "tools/map_text.hpp"
#include "tools/sha256.hpp"
#include "tools/text_lines.hpp"
#include "tools/viewer.hpp"
#include "transfer/rig.hpp"

namespace crosspatch {
namespace {

using test::Program;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(Program, DoctorTellsVersionsAndLimits) {
  const test::Outcome told = run("doctor");
  EXPECT_EQ(told.exit_code, 0);
  for (const char* word : {"OpenImageIO", "threads", "20 million", "reports"})
    EXPECT_THAT(told.out, HasSubstr(word));
}

TEST_F(Program, HelpAndVersionGoToStandardOutput) {
  for (const char* command :
       {"", "inspect ", "match ", "map ", "transfer ", "render ", "doctor "}) {
    const test::Outcome help = run(std::string(command) + "--help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.out, HasSubstr("Usage:"));
    EXPECT_EQ(help.err, "");
    if (*command != '\0') {
      EXPECT_THAT(
          help.out,
          HasSubstr("Examples:\n  crosspatch " + std::string(command, std::strlen(command) - 1)));
    }
  }
  EXPECT_THAT(run("--version").out,
              testing::MatchesRegex(
                  "crosspatch [0-9]+\\.[0-9]+\\.[0-9]+\nwith Boost .*tinygltf [0-9.]+\n"));
}

TEST_F(Program, WrongUsageEndsWithTwo) {
  write_off("mesh.off", shapes::icosphere(1));
  expect_error("", 2, "A subcommand is required");
  expect_error("paint mesh.off", 2, "'paint' is no command");
  expect_error("inspect", 2, "MESH");
  expect_error("inspect mesh.off --bogus", 2, "--bogus");
  expect_error("inspect mesh.off --threads 0", 2, "--threads");
  expect_error("render mesh.off", 2, "--output");
  expect_error("render mesh.off --output out/a.png --size 10", 2, "WIDTHxHEIGHT");
  expect_error("render mesh.off --output out/a.png --size 9x900", 2, "9 is outside [16, 16384]");
  expect_error("render mesh.off --output out/a.png --views front,above", 2, "above");
  expect_error("render mesh.off --output out/a.png --texture wood", 2, "wood");
  expect_error("render mesh.off --output out/a.png --map map.txt", 2, "MESH2");
  expect_error("render mesh.off mesh.off --lines --output out/a.png", 2, "needs MESH2 and --landm");
  const std::string match = "match mesh.off mesh.off --output out/m.csv ";
  expect_error(match + "--method guess", 2, "'guess' is none of default, paper");
  expect_error(match + "--method paper --landmarks pairs.txt", 2, "takes no --landmarks");
}

TEST_F(Program, OutputsThatCannotBeWrittenAreToldBeforeTheWork) {
  write_off("mesh.off", shapes::icosphere(1));
  expect_error("render missing.off --output nowhere/a.png", 2, "folder 'nowhere' does not exist");
  expect_error("render mesh.off --output out", 2, "is a folder");
  expect_error("render mesh.off --output out/a --json out/../out/a", 2, "named twice");
}

TEST_F(Program, BadInputEndsWithThree) {
  const TriangleMesh sphere = shapes::icosphere(1);  // 42 vertices, 80 faces
  write_off("mesh.off", sphere);
  write("broken.off", "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n");
  write("map.txt", "3 1 0 0\n80 1 0 0\n");
  write("short.txt", "3 1 0 0\n");
  write("sum.txt", "-1 0 0 0\n3 0.5 0.6 0\n");
  write("landmarks.txt", "# pairs\n0 1\n\n2 x\n");
  write("range.txt", "0 1\n2 42\n");
  write("twice.txt", "0 1\n2 3 # fine\n0 4\n");
  write("field.txt", "1 2 3\n");
  expect_error("inspect missing.off", 3, "missing.off");
  expect_error("inspect broken.off", 3, "broken.off");
  const std::string pair = "render mesh.off mesh.off --output out/a.png ";
  expect_error(pair + "--map map.txt", 3, "map.txt: line 2: face 80 is outside [-1, 80)");
  expect_error(pair + "--map short.txt", 3, "short.txt: 1 lines for 42 vertices");
  expect_error(pair + "--map sum.txt", 3, "sum.txt: line 2: barycentric coordinates sum to 1.1");
  expect_error(pair + "--landmarks landmarks.txt", 3, "landmarks.txt: line 4: not of the form");
  expect_error(pair + "--landmarks range.txt", 3, "line 2: target vertex 42 is outside [0, 42)");
  expect_error(
      pair + "--landmarks twice.txt", 3, "line 3: source vertex 0 is already used in line 1");
  expect_error(pair + "--field field.txt", 3, "3 numbers for 42 vertices and 80 triangles");
}

TEST_F(Program, AFailedRunLeavesEarlierOutputsAlone) {
  write("out/a.png", "precious");
  EXPECT_EQ(run("render missing.off --output out/a.png").exit_code, 3);
  EXPECT_THAT(written(), ElementsAre("a.png"));
  EXPECT_EQ(test::read_text(folder / "out/a.png"), "precious");
}

TEST_F(Program, RenderReplacesItsOutputAndLeavesNothingElse) {
  write_off("mesh.off", shapes::icosphere(2));
  write("out/a.png", "old");
  const test::Outcome done = run("render mesh.off --output out/a.png --size 120x90");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(written(), ElementsAre("a.png"));
  EXPECT_THAT(test::read_text(folder / "out/a.png"), testing::StartsWith("\x89PNG"));
}

TEST_F(Program, ThreadsDoNotChangeTheBytes) {
  write_off("mesh.off", shapes::torus(2, 0.7, 40, 20));
  for (const char* threads : {"1", "2"})
    EXPECT_EQ(run(std::string("render mesh.off mesh.off --size 200x150 --output out/") + threads +
                  " --threads " + threads)
                  .exit_code,
              0);
  EXPECT_EQ(test::read_text(folder / "out/1"), test::read_text(folder / "out/2"));
}

/// Two bent ellipsoids with the same triangles, the first with UVs, and landmarks that pair
/// vertices 0 to 3 with themselves.
class PairOfSurfaces : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write_obj("source.obj", egg(1.6));
    write_off("target.off", egg(1.4));
    write("pairs.txt", "0 0\n1 1\n2 2\n3 3\n");
  }

  static TriangleMesh egg(double length) {
    TriangleMesh mesh = shapes::icosphere(3);
    for (auto p : mesh.V.rowwise())
      p = Eigen::RowVector3d(
          length * p.x() + 0.2 * p.y() * p.y(), p.y(), 0.8 * p.z() - 0.1 * p.x());
    return mesh;
  }

  void write_obj(const std::string& name, const TriangleMesh& mesh) const {
    std::ofstream file(folder / name);
    for (const auto& p : mesh.V.rowwise())
      file << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << "\nvt " << (p.x() + 1) / 2 << ' '
           << (p.y() + 1) / 2 << '\n';
    for (const auto& f : mesh.F.rowwise()) {
      file << 'f';
      for (const int v : f) file << ' ' << v + 1 << '/' << v + 1;
      file << '\n';
    }
  }
};

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

TEST_F(PairOfSurfaces, ThreadsDoNotChangeTheBytesOfMapAndTexture) {
  for (const std::string threads : {"1", "2"}) {
    const std::string common = " source.obj target.off --threads " + threads + " --quiet --output ";
    EXPECT_EQ(
        run("map" + common + "out/map" + threads + " --overlay out/overlay" + threads).exit_code,
        0);
    EXPECT_EQ(run("transfer" + common + "out/keep" + threads + ".glb").exit_code, 0);
    EXPECT_EQ(run("transfer" + common + "out/bake" + threads + ".glb --mode bake --size 128" +
                  " --map out/overlay" + threads)
                  .exit_code,
              0);
  }
  for (const auto& [name, extension] : std::map<std::string, std::string>{
           {"out/map", ""}, {"out/overlay", ""}, {"out/keep", ".glb"}, {"out/bake", ".glb"}})
    EXPECT_EQ(test::read_text(folder / (name + "1" + extension)),
              test::read_text(folder / (name + "2" + extension)))
        << name;
  EXPECT_TRUE(test::read_text(folder / "out/bake1.glb").starts_with("glTF"));
}

TEST_F(PairOfSurfaces, BakedImagesLieBesideTheirMesh) {
  ASSERT_EQ(run("map source.obj target.off --quiet -o out/map --overlay out/overlay").exit_code, 0);
  const std::string given = "transfer source.obj target.off --quiet --map out/overlay ";
  EXPECT_EQ(
      run(given + "--mode bake --size 64 --bits 16 -o out/b.gltf --json out/b.json").exit_code, 0);
  EXPECT_THAT(written(),
              testing::UnorderedElementsAre(
                  "map", "overlay", "b.gltf", "b.bin", "b_base_color.png", "b.json"));
  const auto report = nlohmann::json::parse(test::read_text(folder / "out/b.json"));
  EXPECT_EQ(report["quality"]["texels_filled"].get<double>(), 1);
  EXPECT_EQ(report["options"]["mode"], "bake");
  EXPECT_FALSE(report["quality"].contains("margin"));  // nothing was chosen
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

TEST_F(PairOfSurfaces, TransferOptionsThatContradictAreRefused) {
  const std::string pair = "transfer source.obj target.off --mode bake --output out/";
  for (const auto& [options, line] : std::map<std::string, std::string>{
           {"a.fbx", "--output: 'out/a.fbx' is no .glb, .gltf, .obj or .ply"},
           {"a.glb --image exr", "--image exr: only an .obj can refer to EXR images"},
           {"a.glb --image jpeg --bits 16", "--bits 16: a JPEG has 8"},
           {"a.obj --image exr --round-trip", "--round-trip: it reads PNG and JPEG, not EXR"},
           {"a.glb -q -v", "--quiet and --verbose contradict each other"},
           {"a.glb --map m --landmarks l",
            "--map and --landmarks: a given map needs no landmarks"}}) {
    const test::Outcome done = run(pair + options);
    EXPECT_EQ(done.exit_code, 2) << options;
    EXPECT_THAT(done.err, testing::HasSubstr(line));
  }
  EXPECT_THAT(written(), testing::IsEmpty());
}

TEST_F(PairOfSurfaces, MapsOfOtherProgramsAreUsed) {
  // Both have the same vertices: the identity maps one onto the other, counted from 0 or from 1.
  std::string from_zero, from_one, scattered;
  for (int v = 0; v < 642; ++v) {
    from_zero += std::to_string(v) + '\n';
    from_one += std::to_string(v + 1) + '\n';
    scattered += std::to_string(v * 251 % 642) + '\n';
  }
  write("zero.txt", from_zero);
  write("one.txt", from_one);
  write("scattered.txt", scattered);
  const std::string pair = "transfer source.obj target.off --quiet --output out/";
  const test::Outcome zero = run(pair + "zero.glb --map zero.txt --json out/zero.json");
  EXPECT_EQ(zero.exit_code, 0) << zero.err;
  EXPECT_EQ(zero.err, "");
  EXPECT_EQ(run(pair + "one.glb --map one.txt --map-base 1").exit_code, 0);
  EXPECT_EQ(test::read_text(folder / "out/zero.glb"), test::read_text(folder / "out/one.glb"));
  const auto quality = nlohmann::json::parse(test::read_text(folder / "out/zero.json"))["quality"];
  EXPECT_EQ(quality["triangles"], 1280) << "no triangle is cut";
  EXPECT_EQ(quality["map_torn_source_triangles"], 0);
  EXPECT_EQ(run(pair + "bake.glb --map zero.txt --texture checker --mode bake --size 64").exit_code,
            0);
  // A permutation is torn all over.
  const test::Outcome torn = run(pair + "torn.glb --map scattered.txt --json out/torn.json");
  EXPECT_EQ(torn.exit_code, 1);
  EXPECT_THAT(torn.err, HasSubstr("the given map is no continuous one: of 1280 source triangles"));
  EXPECT_THAT(torn.err, HasSubstr("target triangles stay grey"));
  const auto report = nlohmann::json::parse(test::read_text(folder / "out/torn.json"));
  EXPECT_GT(report["quality"]["map_torn_source_triangles"], 1150);
  EXPECT_EQ(report["exit_code"], 1);
}

TEST_F(PairOfSurfaces, AMapOfPointsIsNearTheOneItWasWrittenFrom) {
  ASSERT_EQ(run("map source.obj target.off --landmarks pairs.txt --quiet --output out/map.txt "
                "--overlay out/overlay.txt")
                .exit_code,
            0);
  std::string csv = "x,y,z\n";
  const TriangleMesh source = egg(1.6);
  for (const auto& p : source.V.rowwise())
    csv += std::to_string(p.x()) + ',' + std::to_string(p.y()) + ',' + std::to_string(p.z()) + '\n';
  write("places.csv", csv);
  for (const std::string name : {"map", "overlay"}) {
    const test::Outcome done =
        run("transfer source.obj target.off --quiet --map out/" + name + ".txt --output out/" +
            name + ".glb --attributes places.csv --json out/" + name + ".json");
    // At most, some thin pieces are turned over.
    EXPECT_THAT(done.exit_code, testing::AnyOf(0, name == "map" ? 1 : 0)) << done.err;
    const auto report = nlohmann::json::parse(test::read_text(folder / ("out/" + name + ".json")));
    EXPECT_NEAR(report["quality"]["coverage"].get<double>(), 1, 1e-6);
  }
  const std::string a = test::read_text(folder / "out/map_places.csv");
  const std::string b = test::read_text(folder / "out/overlay_places.csv");
  const auto points = text_lines(a), exact = text_lines(b);
  ASSERT_EQ(points.size(), 643u);
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      double p = 0, q = 0;
      ASSERT_TRUE(parse_number(points[i].words[k], p) && parse_number(exact[i].words[k], q));
      sum += std::abs(p - q);
    }
  // An edge is about 0.18 long; between the points the map is unknown.
  EXPECT_LT(sum / 642, 0.03);
}

TEST_F(PairOfSurfaces, MapsThatDoNotFitAreRefused) {
  write("short.txt", "1\n2\n");
  write("range.txt", "642\n");
  write("sum.txt", "3 0.5 0.6 0\n");
  write("overlay.txt", "crosspatch-overlay 1\n0 0\n");
  const std::string start = "transfer source.obj target.off --output out/a.glb ";
  expect_error(start + "--map short.txt", 3, "short.txt: 2 lines for the source's 642 vertices");
  expect_error(start + "--map range.txt", 3, "range.txt: line 1: vertex 642 is outside [0, 642)");
  expect_error(start + "--map sum.txt", 3, "sum.txt: line 1: barycentric coordinates sum to 1.1");
  expect_error(start + "--map overlay.txt --map-base 1", 3, "an overlay counts from 0, not from 1");
  expect_error(start + "--map-base 1", 2, "--map-base: no --map is given");
  expect_error(start + "--map short.txt --map-base 2", 2, "--map-base");
}

TEST_F(PairOfSurfaces, AttributesAreCarried) {
  // The pair has the same triangles; a map that is the identity by vertices shows what arrives.
  std::string csv = "x,label:half\n";
  const TriangleMesh mesh = egg(1.6);
  for (int v = 0; v < mesh.vertex_count(); ++v)
    csv += std::to_string(mesh.V(v, 0)) + (mesh.V(v, 2) > 0 ? ",1\n" : ",0\n");
  write("heat.csv", csv);
  write("marks.json",
        R"({"landmarks": [{"name": "first", "point": 0}],
            "curves": [{"name": "way", "points": [0, 1, 2]}]})");
  const test::Outcome done =
      run("transfer source.obj target.off --landmarks pairs.txt --output out/a.glb --json "
          "out/a.json --attributes heat.csv --attributes marks.json --attributes heat.csv "
          "--attributes-output out/heat.csv --attributes-output out/marks.json "
          "--attributes-output out/heat.ply");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(written(), ElementsAre("a.glb", "a.json", "heat.csv", "heat.ply", "marks.json"));
  EXPECT_THAT(done.err, HasSubstr("4 fields, 1 landmarks, 1 curves"));
  const auto quality = nlohmann::json::parse(test::read_text(folder / "out/a.json"))["quality"];
  EXPECT_EQ(quality["attribute_unmapped_vertices"], 0);
  EXPECT_EQ(quality["attribute_curve_gaps"], 0);
  const auto lines = text_lines(test::read_text(folder / "out/heat.csv"));
  ASSERT_EQ(lines.size(), 643u);
  double x = 0;
  ASSERT_TRUE(parse_number(lines[1].words[0], x));
  EXPECT_NEAR(x, mesh.V(0, 0), 1e-5) << "a landmark, met exactly; the CSV has six digits";
  const auto marks = nlohmann::json::parse(test::read_text(folder / "out/marks.json"));
  const TriangleMesh target = egg(1.4);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(
        marks["landmarks"][0]["position"].at(std::size_t(k)).get<double>(), target.V(0, k), 1e-9);
    EXPECT_NEAR(marks["curves"][0]["positions"].back().at(std::size_t(k)).get<double>(),
                target.V(2, k),
                1e-9);
  }
  // Its own output is a mesh, and a source of attributes again.
  const test::Outcome back =
      run("transfer out/heat.ply source.obj --output out/b.glb --texture position --attributes "
          "out/heat.ply");
  EXPECT_EQ(back.exit_code, 0) << back.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/b_heat.ply"));
}

TEST_F(PairOfSurfaces, AttributesThatDoNotFitAreRefused) {
  write("short.csv", "a\n1\n");
  write("marks.json", R"({"landmarks": [{"point": 642}]})");
  const std::string start = "transfer source.obj target.off --output out/a.glb --attributes ";
  expect_error(start + "short.csv", 3, "short.csv: 1 rows for 642 vertices");
  expect_error(start + "marks.json", 3, "vertex 642 is outside [0, 642)");
  expect_error(start + "gone.csv", 3, "gone.csv");
  expect_error(start + "target.off", 2, "'target.off' is no .csv, .ply or .json");
  expect_error(start + "short.csv --attributes-output out/a.json", 2, "is no .csv or .ply");
  expect_error(start + "short.csv --attributes-output out/a.glb", 2, "is no .csv or .ply");
  expect_error(start + "short.csv --attributes-output out/a.csv --attributes-output out/b.csv",
               2,
               "2 times");
  expect_error(start + "a.csv --attributes b/a.csv", 2, "named twice");
}

TEST_F(PairOfSurfaces, SkinsAndMorphTargetsAreCarried) {
  const TriangleMesh mesh = egg(1.6);
  write("source.glb", rig::file(mesh.V, mesh.F).glb());
  const std::string start =
      "transfer source.glb target.off --landmarks pairs.txt --json out/a.json ";
  const auto report = [&] { return nlohmann::json::parse(test::read_text(folder / "out/a.json")); };
  for (const std::string mode : {"keep", "bake --size 16 --texture checker"}) {
    const test::Outcome done = run(start + "--skin --morphs --output out/a.gltf --mode " + mode);
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr("2 joints, 2 morph targets, 1 animation"));
    EXPECT_EQ(done.err.find("not carried"), std::string::npos) << done.err;
    EXPECT_EQ(report()["quality"]["skin_joints"], 2);
    EXPECT_EQ(report()["quality"]["motion_unmapped_positions"], 0);
    const auto gltf = nlohmann::json::parse(test::read_text(folder / "out/a.gltf"));
    EXPECT_EQ(gltf["skins"][0]["joints"].size(), 2u);
    EXPECT_EQ(gltf["meshes"][0]["extras"]["targetNames"], nlohmann::json({"puffed", "bent"}));
    EXPECT_EQ(gltf["animations"][0]["channels"].size(), 4u);
  }
  // What stays behind is told.
  const test::Outcome plain = run(start + "--output out/a.glb");
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_THAT(plain.err,
              HasSubstr("the source has what is not carried: a skin (--skin), 2 morph targets "
                        "(--morphs), 1 animation"));
  // And what moves can be the source again.
  ASSERT_EQ(run(start + "--skin --output out/b.glb").exit_code, 0);
  const test::Outcome again = run("transfer out/b.glb source.obj --skin --output out/c.glb");
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(PairOfSurfaces, MotionThatIsNotThereIsRefused) {
  const std::string start = "transfer source.obj target.off --landmarks pairs.txt ";
  expect_error(start + "--skin --output out/a.glb", 3, "source.obj: has no skin");
  expect_error(start + "--morphs --output out/a.glb", 3, "source.obj: has no morph targets");
  expect_error(start + "--skin --output out/a.obj", 2, "--skin: only a .glb or .gltf can hold it");
  expect_error(start + "--morphs --output out/a.ply", 2, "--morphs: only a .glb or .gltf");
  const TriangleMesh mesh = egg(1.6);
  files::Gltf spoilt = rig::file(mesh.V, mesh.F);
  spoilt.json["skins"][0]["joints"] = {2, 2};
  write("spoilt.glb", spoilt.glb());
  expect_error("transfer spoilt.glb target.off --skin --output out/a.glb", 3, "comes twice");
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

TEST_F(PairOfSurfaces, AnInterruptedRunLeavesNothing) {
  // Interrupted long before it can be done: reading alone starts later than that.
  const std::string command =
      "cd '" + folder.string() +
      "' && timeout --signal=INT 0.3 '" CROSSPATCH_PROGRAM
      "' transfer source.obj target.off --quiet --output out/a.glb --json out/a.json 2>/dev/null";
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_TRUE(written().empty());
}

TEST_F(Program, QuietIsQuiet) {
  write_off("mesh.off", shapes::icosphere(1));
  const test::Outcome done = run("inspect mesh.off --quiet");
  EXPECT_EQ(done.err, "");
  EXPECT_THAT(done.out, HasSubstr("mesh_triangles: 80\n"));
  EXPECT_THAT(run("inspect mesh.off").err, HasSubstr("read "));
}

TEST_F(Program, JsonReportHasTheFieldsOfItsSchema) {
  write_off("mesh.off", shapes::torus(2, 0.7, 8, 6));
  write("landmarks.txt", "0 0\n");
  ASSERT_EQ(run("inspect mesh.off --json out/report.json").exit_code, 0);
  const auto report = nlohmann::json::parse(test::read_text(folder / "out/report.json"));
  EXPECT_EQ(report["schema"]["name"], "crosspatch-report");
  EXPECT_EQ(report["schema"]["version"], 1);
  EXPECT_EQ(report["program"]["command"], "inspect");
  const auto& input = report["inputs"].at(0);
  EXPECT_EQ(input["path"], "mesh.off");
  const std::string bytes = test::read_text(folder / "mesh.off");
  EXPECT_EQ(input["bytes"], bytes.size());
  EXPECT_EQ(input["sha256"], sha256(bytes));
  EXPECT_EQ(input["counts"]["genus"], 1);
  EXPECT_EQ(input["counts"]["mesh_triangles"], 96);
  EXPECT_TRUE(input["repairs"].empty());
  ASSERT_EQ(report["stages"].size(), 1u);
  EXPECT_EQ(report["stages"][0]["name"], "read");
  EXPECT_GT(report["stages"][0]["seconds"], 0);
  EXPECT_GT(report["stages"][0]["peak_memory_mib"], 1);
  EXPECT_EQ(report["exit_code"], 0);

  const test::Outcome piped = run("inspect mesh.off --json -");
  EXPECT_EQ(nlohmann::json::parse(piped.out)["inputs"], report["inputs"]);
  ASSERT_EQ(
      run("render mesh.off mesh.off --landmarks landmarks.txt --size 64x64 --output out/a.png "
          "--json out/render.json")
          .exit_code,
      0);
  EXPECT_EQ(run("render mesh.off mesh.off --landmarks landmarks.txt --lines --size 64x64 --output "
                "out/lines.png")
                .exit_code,
            0);
  const auto drawn = nlohmann::json::parse(test::read_text(folder / "out/render.json"));
  EXPECT_EQ(drawn["outputs"], nlohmann::json::array({"out/a.png"}));
  EXPECT_EQ(drawn["inputs"].size(), 3u);
  EXPECT_EQ(drawn["inputs"][2]["sha256"], sha256("0 0\n"));
}

}  // namespace
}  // namespace crosspatch
