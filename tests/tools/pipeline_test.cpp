#include "tools/pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace crosspatch {
namespace {

TEST(CrumpledSentence, TellsTheEnergyOfMapsThatWereFoundAndOnlyBeyondTheBound) {
  MatchedMap matched;
  matched.result.quality.percentile_99 = 2 * kMostEnergy;
  EXPECT_EQ(crumpled_sentence(matched), "");  // the map was given
  matched.ranking.emplace_back();
  EXPECT_THAT(crumpled_sentence(matched), testing::HasSubstr("energy of 2e+03, 1000 is the most"));
  matched.result.quality.percentile_99 = kMostEnergy;
  EXPECT_EQ(crumpled_sentence(matched), "");
}

}  // namespace
}  // namespace crosspatch
