#include "transfer/gltf_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

#include "core/index.hpp"
#include "shapes.hpp"
#include "temp_folder.hpp"
#include "transfer/gltf_read.hpp"
#include "transfer/rig.hpp"

namespace crosspatch {
namespace {

using files::Gltf;
using nlohmann::json;

constexpr MotionParts kAll{.skin = true, .morphs = true};

Gltf sheet() {
  const TriangleMesh grid = shapes::grid(4);
  return rig::file(grid.V, grid.F);
}

Result<ReadMotion> read(const std::string& bytes, const MotionParts& parts = kAll) {
  const TempFolder folder;
  return read_gltf_motion(folder.write("a.glb", bytes), parts);
}

TEST(GltfMotion, SaysWhatTheFileSays) {
  const Gltf file = sheet();
  const auto out = read(file.glb());
  ASSERT_TRUE(out) << out.error().message;
  const Motion& motion = out->motion;
  const TriangleMesh grid = shapes::grid(4);
  ASSERT_TRUE(validate(motion, grid.vertex_count()));
  EXPECT_EQ(out->tracks_left_out, 0);

  const rig::Bones bones;
  ASSERT_EQ(motion.skin->nodes.size(), 3u);
  EXPECT_EQ(motion.skin->nodes[0].name, "above");
  EXPECT_EQ(motion.skin->nodes[2].name, "knee");
  EXPECT_EQ(motion.skin->nodes[2].parent, 1);
  // Matrices are single precision in the file.
  EXPECT_TRUE(motion.skin->nodes[1].bind.isApprox(bones.hip, 1e-6));
  EXPECT_TRUE(motion.skin->nodes[2].bind.isApprox(bones.knee, 1e-6));
  EXPECT_TRUE(motion.skin->nodes[0].bind.isApprox(rig::frame({0, 1, 0}, 0.3, {1, 0, 0}), 1e-6));
  for (int v = 0; v < grid.vertex_count(); ++v)
    EXPECT_FLOAT_EQ(float(motion.skin->weights.coeff(v, 1)), float(grid.V(v, 0)));

  ASSERT_EQ(motion.morphs.size(), 2u);
  EXPECT_EQ(motion.morphs[0].name, "puffed");
  EXPECT_EQ(motion.morphs[0].weight, 0.25);
  EXPECT_EQ(motion.morphs[0].normal_displacements.rows(), 0);
  EXPECT_EQ(motion.morphs[1].normal_displacements.rows(), grid.vertex_count());
  EXPECT_FLOAT_EQ(float(motion.morphs[1].displacements(grid.vertex_count() - 1, 1)), 0.2F);

  ASSERT_EQ(motion.animations.size(), 1u);
  ASSERT_EQ(motion.animations[0].tracks.size(), 4u);
  EXPECT_EQ(motion.animations[0].tracks[2].interpolation, Interpolation::kCubicSpline);
  EXPECT_EQ(motion.animations[0].tracks[3].node, -1);
}

TEST(GltfMotion, PartsThatAreNotAskedForAreNotRead) {
  const Gltf file = sheet();
  const auto skin = read(file.glb(), {.skin = true}), morphs = read(file.glb(), {.morphs = true});
  ASSERT_TRUE(skin && morphs);
  EXPECT_TRUE(skin->motion.skin && skin->motion.morphs.empty());
  EXPECT_EQ(skin->motion.animations[0].tracks.size(), 3u);
  EXPECT_EQ(skin->tracks_left_out, 1);
  EXPECT_TRUE(!morphs->motion.skin && morphs->motion.morphs.size() == 2);
  EXPECT_EQ(morphs->motion.animations[0].tracks.size(), 1u);
}

TEST(GltfMotion, TheReaderOfMeshesTellsThatItIsThere) {
  const TempFolder folder;
  const auto soup = read_gltf(folder.write("a.glb", sheet().glb()));
  ASSERT_TRUE(soup);
  EXPECT_TRUE(soup->skinned);
  EXPECT_EQ(soup->morph_targets, 2);
  EXPECT_EQ(soup->animations, 1);
  EXPECT_THAT(soup->notes, testing::Contains(testing::HasSubstr("bind pose")));
}

TEST(GltfMotion, VerticesAreNumberedLikeThoseOfTheMesh) {
  // A primitive of points in front, and the mesh shown a second time by a node without a skin.
  Gltf file = sheet();
  json& primitives = file.json["meshes"][0]["primitives"];
  json points = primitives[0];
  points["mode"] = 0;
  points.erase("targets");
  primitives.insert(primitives.begin(), points);
  file.json["nodes"].push_back({{"mesh", 0}, {"scale", {2, 2, 2}}});
  file.json["scenes"][0]["nodes"] = {0, 1, 4};
  const TempFolder folder;
  const auto path = folder.write("a.glb", file.glb());
  const auto soup = read_gltf(path);
  const auto motion = read_gltf_motion(path, kAll);
  ASSERT_TRUE(soup && motion) << (soup ? motion.error().message : soup.error().message);
  const int n = shapes::grid(4).vertex_count();
  ASSERT_EQ(soup->positions.rows(), 2 * n);
  ASSERT_TRUE(validate(motion->motion, 2 * n));
  EXPECT_EQ(motion->motion.skin->weights.row(0).nonZeros(), 1);
  EXPECT_EQ(motion->motion.skin->weights.row(n).sum(), 0);
  EXPECT_TRUE(motion->motion.morphs[0].displacements.row(2 * n - 1).isApprox(
      2 * motion->motion.morphs[0].displacements.row(n - 1)));
}

TEST(GltfMotion, APoseAtRestThatIsNotTheBindPoseIsHeld) {
  Gltf file = sheet();
  const Eigen::Quaterniond posed(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()));
  file.json["nodes"][2]["rotation"] = rig::numbers(posed);
  const auto out = read(file.glb());
  ASSERT_TRUE(out);
  // The hip is the topmost joint: where it stands at rest decides what is above it. The knee's
  // place to the hip is that of the bind pose still.
  const auto& tracks = out->motion.animations[0].tracks;
  EXPECT_EQ(tracks.size(), 4u);
  Gltf bent = sheet();
  bent.json["nodes"][3]["translation"] = {0.1, 0.2, 0.9};
  const auto held = read(bent.glb());
  ASSERT_TRUE(held);
  ASSERT_EQ(held->motion.animations[0].tracks.size(), 5u);
  const Track& track = held->motion.animations[0].tracks.back();
  EXPECT_EQ(track.node, 2);
  EXPECT_EQ(track.path, TrackPath::kTranslation);
  EXPECT_EQ(track.values, (std::vector<double>{0.1, 0.2, 0.9}));
}

struct Spoilt {
  std::string name, says;
  std::function<void(Gltf&)> change;
};

std::vector<Spoilt> spoilt_files() {
  const auto attribute = [](Gltf& g, const char* name) -> json& {
    return g.json["accessors"]
                 [g.json["meshes"][0]["primitives"][0]["attributes"][name].get<std::size_t>()];
  };
  const auto put = [](Gltf& g, json& accessor, std::size_t at, const std::string& bytes) {
    const json& view = g.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    g.binary.replace(view["byteOffset"].get<std::size_t>() + at, bytes.size(), bytes);
  };
  const auto float_bytes = [](double v) { return files::floats({v}); };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto sampler_values = [](Gltf& g, int sampler, const char* part) -> json& {
    return g.json["accessors"]
                 [g.json["animations"][0]["samplers"][idx(sampler)][part].get<std::size_t>()];
  };
  const auto inverse = [](Gltf& g) -> json& {
    return g.json["accessors"][g.json["skins"][0]["inverseBindMatrices"].get<std::size_t>()];
  };
  return {
      {"no skin", "has a skin", [](Gltf& g) { g.json["nodes"][0].erase("skin"); }},
      {"no targets",
       "has morph targets",
       [](Gltf& g) { g.json["meshes"][0]["primitives"][0].erase("targets"); }},
      {"missing skin", "index 7 into skins", [](Gltf& g) { g.json["nodes"][0]["skin"] = 7; }},
      {"missing joint",
       "index 99 into nodes",
       [](Gltf& g) { g.json["skins"][0]["joints"][1] = 99; }},
      {"joints are no list", "is no array", [](Gltf& g) { g.json["skins"][0]["joints"] = 3; }},
      {"no joints", "has no joints", [](Gltf& g) { g.json["skins"][0]["joints"] = json::array(); }},
      {"joint twice",
       "comes twice",
       [](Gltf& g) {
         g.json["skins"][0]["joints"] = {2, 2};
       }},
      {"missing matrices",
       "index 99 into accessors",
       [](Gltf& g) { g.json["skins"][0]["inverseBindMatrices"] = 99; }},
      {"too few matrices",
       "1 inverse bind matrices of 16 numbers for 2 joints",
       [=](Gltf& g) { inverse(g)["count"] = 1; }},
      {"matrices of vectors",
       "of 4 numbers for 2 joints",
       [=](Gltf& g) { inverse(g)["type"] = "VEC4"; }},
      {"matrices past their view", "do not fit", [=](Gltf& g) { inverse(g)["count"] = 50; }},
      {"matrix with NaN",
       "joint 1: the inverse bind matrix is not finite",
       [=](Gltf& g) { put(g, inverse(g), 64, float_bytes(nan)); }},
      {"matrix of projection",
       "joint 0: the inverse bind matrix is not affine",
       [=](Gltf& g) { put(g, inverse(g), 12, float_bytes(1)); }},
      {"matrix of NaN projection",
       "joint 0: the inverse bind matrix is not affine",
       [=](Gltf& g) { put(g, inverse(g), 60, float_bytes(nan)); }},
      {"matrix of zeros",
       "joint 0: the inverse bind matrix has no inverse",
       [=](Gltf& g) { put(g, inverse(g), 0, files::floats(std::vector<double>(12, 0.0))); }},
      {"matrix that mirrors",
       "joint 0: the inverse bind matrix mirrors",
       [=](Gltf& g) {
         put(g, inverse(g), 0, files::floats({-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
       }},
      {"joint of two parents",
       "two parents",
       [](Gltf& g) {
         g.json["nodes"].push_back({{"children", {3}}});
       }},
      {"joint above itself",
       "its own ancestor",
       [](Gltf& g) {
         g.json["nodes"][3]["children"] = {2};
         g.json["nodes"][1].erase("children");
         g.json["scenes"][0]["nodes"] = {0};
       }},
      {"joint of no size above",
       "node 1: its bind frame",
       [](Gltf& g) {
         g.json["nodes"][2]["scale"] = {0, 0, 0};
       }},
      {"joints without weights",
       "must come together",
       [](Gltf& g) { g.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); }},
      {"weights of three",
       "have 25 elements of 3 for 25 vertices",
       [=](Gltf& g) { attribute(g, "WEIGHTS_0")["type"] = "VEC3"; }},
      {"too few weights",
       "have 24 elements of 4 for 25 vertices",
       [=](Gltf& g) { attribute(g, "WEIGHTS_0")["count"] = 24; }},
      {"weight NaN",
       "vertex 0 has weight nan",
       [=](Gltf& g) { put(g, attribute(g, "WEIGHTS_0"), 0, float_bytes(nan)); }},
      {"weight negative",
       "vertex 0 has weight -1",
       [=](Gltf& g) { put(g, attribute(g, "WEIGHTS_0"), 0, float_bytes(-1)); }},
      {"joint index out of range",
       "vertex 0: joint 200 is outside [0, 2)",
       [=](Gltf& g) { put(g, attribute(g, "JOINTS_0"), 0, "\xc8"); }},
      {"targets of another length",
       "POSITION has 24 elements of 3 for 25 vertices",
       [](Gltf& g) {
         const json& target = g.json["meshes"][0]["primitives"][0]["targets"][0];
         g.json["accessors"][target["POSITION"].get<std::size_t>()]["count"] = 24;
       }},
      {"target displaced by NaN",
       "the POSITION of vertex 0 is not finite",
       [=](Gltf& g) {
         const json target = g.json["meshes"][0]["primitives"][0]["targets"][0];
         put(g, g.json["accessors"][target["POSITION"].get<std::size_t>()], 0, float_bytes(nan));
       }},
      {"missing target",
       "index 99 into accessors",
       [](Gltf& g) { g.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 99; }},
      {"targets that differ",
       "has 1 morph targets, another 2",
       [](Gltf& g) {
         json& primitives = g.json["meshes"][0]["primitives"];
         primitives.push_back(primitives[0]);
         primitives[1]["targets"].erase(1);
       }},
      {"three weights of two targets",
       "3 weights for 2 morph targets",
       [](Gltf& g) {
         g.json["meshes"][0]["weights"] = {0, 0, 0};
       }},
      {"thousands of targets out of nothing",
       "displacements are read",
       [](Gltf& g) {
         json& accessors = g.json["accessors"];
         accessors.push_back(
             {{"componentType", files::kFloat}, {"type", "VEC3"}, {"count", 900'000}});
         json& primitive = g.json["meshes"][0]["primitives"][0];
         primitive["attributes"] = {{"POSITION", accessors.size() - 1}};
         primitive["targets"] = json::array();
         for (int i = 0; i < 1000; ++i)
           primitive["targets"].push_back({{"POSITION", accessors.size() - 1}});
         g.json["meshes"][0].erase("weights");
       }},
      {"channel of no sampler",
       "names no sampler of its 4",
       [](Gltf& g) { g.json["animations"][0]["channels"][0]["sampler"] = 4; }},
      {"channel of a missing node",
       "index 99 into nodes",
       [](Gltf& g) { g.json["animations"][0]["channels"][0]["target"]["node"] = 99; }},
      {"sampler without output",
       "a sampler has no output",
       [](Gltf& g) { g.json["animations"][0]["samplers"][0].erase("output"); }},
      {"sampler of missing times",
       "index 99 into accessors",
       [](Gltf& g) { g.json["animations"][0]["samplers"][0]["input"] = 99; }},
      {"animation without channels",
       "no samplers or no channels",
       [](Gltf& g) { g.json["animations"][0].erase("channels"); }},
      {"unknown interpolation",
       "none of glTF's",
       [](Gltf& g) { g.json["animations"][0]["samplers"][0]["interpolation"] = "MAGIC"; }},
      {"two tracks for one thing",
       "another moves the same",
       [](Gltf& g) {
         json& channels = g.json["animations"][0]["channels"];
         channels.push_back(channels[0]);
       }},
      {"times backwards",
       "the time of key 1 is -3",
       [=](Gltf& g) { put(g, sampler_values(g, 0, "input"), 4, float_bytes(-3)); }},
      {"times that stand still",
       "the time of key 1 is 0",
       [=](Gltf& g) { put(g, sampler_values(g, 0, "input"), 4, float_bytes(0)); }},
      {"time NaN",
       "the time of key 0 is nan",
       [=](Gltf& g) { put(g, sampler_values(g, 0, "input"), 0, float_bytes(nan)); }},
      {"value NaN",
       "a key has the value nan",
       [=](Gltf& g) { put(g, sampler_values(g, 1, "output"), 4, float_bytes(nan)); }},
      {"rotation of length 0",
       "the rotation of key 0 has length 0",
       [=](Gltf& g) {
         put(g, sampler_values(g, 0, "output"), 0, files::floats({0, 0, 0, 0}));
       }},
      {"too few values",
       "4 numbers in groups of 4 for 2 keys that need 8",
       [=](Gltf& g) { sampler_values(g, 0, "output")["count"] = 1; }},
      {"rotations of three",
       "numbers in groups of 3",
       [=](Gltf& g) { sampler_values(g, 0, "output")["type"] = "VEC3"; }},
  };
}

TEST(GltfMotion, WhatIsNotSoundIsRefusedInWords) {
  for (const Spoilt& spoilt : spoilt_files()) {
    Gltf file = sheet();
    spoilt.change(file);
    const auto out = read(file.glb());
    ASSERT_FALSE(out) << spoilt.name;
    EXPECT_EQ(out.error().code, ErrorCode::kBadInput) << spoilt.name;
    EXPECT_THAT(out.error().message, testing::HasSubstr(spoilt.says)) << spoilt.name;
    EXPECT_EQ(out.error().message.find('\n'), std::string::npos) << spoilt.name;
  }
}

TEST(GltfMotion, RandomChangesNeverBreakTheReader) {
  const std::string bytes = sheet().glb();
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    std::string changed = bytes;
    for (unsigned change = 0; change < 1 + seed % 8; ++change)
      changed[random() % changed.size()] =
          seed % 2 == 0 ? static_cast<char>(random()) : "0123456789-.,\":[]{}"[random() % 19];
    const auto out = read(changed);
    if (out)
      EXPECT_TRUE(validate(
          out->motion, out->motion.skin ? static_cast<int>(out->motion.skin->weights.rows()) : 0))
          << seed;
    else
      EXPECT_EQ(out.error().code, ErrorCode::kBadInput) << seed << ": " << out.error().message;
  }
}

}  // namespace
}  // namespace crosspatch
