// Drives the built program: textures and what else is carried from one surface to another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "pair_of_surfaces.hpp"
#include "tools/text_lines.hpp"
#include "transfer/rig.hpp"

namespace crosspatch {
namespace {

using test::PairOfSurfaces;
using testing::ElementsAre;
using testing::HasSubstr;

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

TEST_F(PairOfSurfaces, ExrImagesLieBesideAnObjAndHoldHalfFloats) {
  const test::Outcome done =
      run("transfer source.obj target.off --quiet --landmarks pairs.txt --mode bake --size 64 "
          "--texture checker --image exr --output out/b.obj");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(written(), testing::UnorderedElementsAre("b.obj", "b.mtl", "b_base_color.exr"));
  EXPECT_THAT(test::read_text(folder / "out/b.mtl"), HasSubstr("map_Kd b_base_color.exr\n"));
  const std::string exr = test::read_text(folder / "out/b_base_color.exr");
  EXPECT_TRUE(exr.starts_with("\x76\x2f\x31\x01"));  // the format's magic number
  // A channel's entry: its name, then its kind, of which 1 are half floats.
  for (const char channel : {'R', 'G', 'B'})
    EXPECT_THAT(exr, HasSubstr(std::string{channel, 0, 1, 0, 0, 0})) << channel;
}

TEST_F(PairOfSurfaces, TransferOptionsThatContradictAreRefused) {
  const std::string pair = "transfer source.obj target.off --mode bake --output out/";
  for (const auto& [options, line] : std::map<std::string, std::string>{
           {"a.fbx", "--output: 'out/a.fbx' is no .glb, .gltf, .obj or .ply"},
           {"a.glb --image exr",
            "--image exr: 'out/a.glb' cannot refer to EXR images (glTF knows PNG and JPEG, PLY "
            "none): write an .obj"},
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

TEST_F(PairOfSurfaces, TransferOptionsThatTheModeDoesNotReadAreRefused) {
  const std::string pair = "transfer source.obj target.off --output out/a.obj ";
  write("c.toml", "[transfer]\nsize=64\n");
  for (const auto& [options, line] : std::map<std::string, std::string>{
           {"--size 2048", "--size: it needs --mode bake"},
           {"--mode keep --image jpeg", "--image: it needs --mode bake"},
           {"--mode keep --image exr", "--image: it needs --mode bake"},
           {"--mode keep --bits 8", "--bits: it needs --mode bake"},
           {"--round-trip", "--round-trip: it needs --mode bake"},
           {"--config c.toml", "--size: it needs --mode bake"},
           {"--mode bake --uv-tolerance 0.5", "--uv-tolerance: it needs --mode keep"}}) {
    const test::Outcome done = run(pair + options);
    EXPECT_EQ(done.exit_code, 2) << options;
    EXPECT_THAT(done.err, testing::HasSubstr(line));
    EXPECT_EQ(text_lines(done.err).size(), 1u) << done.err;
  }
  EXPECT_THAT(written(), testing::IsEmpty());
  // What is printed for either mode can be read back.
  for (const std::string mode : {"keep", "bake"}) {
    const test::Outcome printed = run(pair + "--mode " + mode + " --print-config");
    EXPECT_EQ(printed.exit_code, 0) << printed.err;
    write("c.toml", printed.out);
    EXPECT_EQ(run("transfer --config c.toml --print-config").out, printed.out);
    EXPECT_EQ(run("transfer --config c.toml --landmarks none.txt").exit_code, 3) << mode;
  }
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
  const std::string heat = test::read_text(folder / "out/heat.csv");
  const auto lines = text_lines(heat);
  ASSERT_EQ(lines.size(), 643u);
  double x = 0;
  ASSERT_TRUE(parse_number(lines[1].words[0], x)) << lines[1].words[0];
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

TEST_F(PairOfSurfaces, AnInterruptedRunLeavesNothing) {
  // Interrupted long before it can be done: reading alone starts later than that.
  const std::string command =
      "cd '" + folder.string() +
      "' && timeout --signal=INT 0.3 '" CROSSPATCH_PROGRAM
      "' transfer source.obj target.off --quiet --output out/a.glb --json out/a.json 2>/dev/null";
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_TRUE(written().empty());
}

}  // namespace
}  // namespace crosspatch
