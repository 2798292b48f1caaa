#include <gtest/gtest.h>

#include "core/prepare.hpp"
#include "core/read_soup.hpp"
#include "data_folder.hpp"
#include "param/match.hpp"

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

}  // namespace
}  // namespace crosspatch
