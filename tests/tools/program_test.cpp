// Drives the built program.
#include "program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "shapes.hpp"
#include "tools/sha256.hpp"

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
