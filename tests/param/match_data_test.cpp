#include <gtest/gtest.h>

#include <fstream>

#include "core/prepare.hpp"
#include "core/read_soup.hpp"
#include "data_folder.hpp"
#include "param/match.hpp"
#include "shapes.hpp"

namespace crosspatch {
namespace {

TEST(MatchData, LimbsDoNotSlipOffTheirCounterparts) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "no data folder: set CROSSPATCH_DATA";
  const auto read = [&](const char* file) {
    return prepare(read_soup(*folder / file).value()).value().mesh;
  };
  // A cow and a donkey, whose legs are longer: where one face swallows a lower leg, one part in a
  // hundred has an energy of 10^4 and more. The donkey's tail has no counterpart.
  const auto matched = match_and_map(read("shrec07/381.off"), read("shrec07/385.off"), {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  EXPECT_LT(matched->result.quality.median, 4.6);
  EXPECT_LT(matched->result.quality.percentile_90, 8);
  EXPECT_LT(matched->result.quality.percentile_99, 1500);
}

TEST(MatchData, ATailDoesNotGoToALeg) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "no data folder: set CROSSPATCH_DATA";
  // A donkey and a horse whose tail is thick as a leg: by its distortion alone the map that takes
  // the thin tail to a hind leg and a hind leg to the thick tail is the better one.
  const auto read = [&](const char* file) {
    return prepare(read_soup(*folder / file).value()).value().mesh;
  };
  const TriangleMesh source = read("shrec07/385.off"), target = read("shrec07/397.off");
  const auto matched = match_and_map(source, target, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  std::ifstream truth(*folder / "gt/s07_fourleg_385_397.corr");
  const SurfaceMap& map = matched->result.map;
  double worst = 0;
  for (int s = 0, t = 0; truth >> s >> t;) {
    const int q = map.point_of_source_vertex[static_cast<std::size_t>(s)];
    const Vector3d image = position(target, map.target[static_cast<std::size_t>(q)]);
    worst = std::max(worst, (image - target.position(t)).norm());
  }
  EXPECT_GT(worst, 0);
  EXPECT_LT(worst / std::sqrt(total_area(target)), 0.25);
}

TEST(MatchData, FingersAreTriedAlongSeveralChains) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "no data folder: set CROSSPATCH_DATA";
  const auto read = [&](const char* file) {
    return prepare(read_soup(*folder / file).value()).value().mesh;
  };
  // The initial map of least distortion through all fingers of these two cannot be unfolded.
  const auto matched =
      match_and_map(read("faust5k/tr_reg_002.off"), read("faust5k/tr_reg_012.off"), {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_LT(matched->result.quality.percentile_99, 10);  // 8.2; 19 where fingers slip
}

TEST(MatchData, FingersDoNotSlipOffEachOther) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "no data folder: set CROSSPATCH_DATA";
  // A person onto the same in other triangles. Coarse levels leave little of fingers, on which
  // these slid towards each other: one part in a hundred had an energy above 14.
  const TriangleMesh person =
      prepare(read_soup(*folder / "faust5k/tr_reg_005.off").value()).value().mesh;
  const TriangleMesh finer = shapes::refined(person);
  const auto matched = match_and_map(person, finer, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  const SurfaceMap& map = matched->result.map;
  double slip = 0;
  for (int v = 0; v < person.vertex_count(); ++v) {
    const int q = map.point_of_source_vertex[static_cast<std::size_t>(v)];
    const Vector3d image = position(finer, map.target[static_cast<std::size_t>(q)]);
    slip += (image - person.position(v)).norm() / person.vertex_count();
  }
  EXPECT_LT(slip / std::sqrt(total_area(person)), 2.5e-3);  // 0.0016; 0.0035 when they slip
  EXPECT_LT(matched->result.quality.percentile_99, 7);      // 5.1, and 4 is an isometry
}

}  // namespace
}  // namespace crosspatch
