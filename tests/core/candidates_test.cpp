#include "core/candidates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/creatures.hpp"

namespace crosspatch {
namespace {

/// n tips scattered in a cube, with their coordinates as signature.
TipDescriptors scattered(int n, unsigned seed) {
  std::mt19937 random(seed);
  TipDescriptors tips{Eigen::MatrixXd(n, 3), Eigen::MatrixXd(n, n)};
  for (double& x : tips.signature.reshaped()) x = static_cast<double>(random()) / 4294967296.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      tips.distance(i, j) = (tips.signature.row(i) - tips.signature.row(j)).norm();
  return tips;
}

TipDescriptors reordered(const TipDescriptors& tips, const std::vector<int>& order) {
  return {tips.signature(order, Eigen::all), tips.distance(order, order)};
}

void expect_well_formed(const std::vector<TipAssignment>& list, int n1, int n2) {
  std::set<std::vector<std::pair<int, int>>> seen;
  for (size_t i = 0; i < list.size(); ++i) {
    EXPECT_TRUE(seen.insert(list[i].pairs).second) << "twice: " << i;
    if (i > 0) {
      EXPECT_GE(list[i].cost, list[i - 1].cost);
    }
    std::set<int> sources, targets;
    for (const auto& [s, t] : list[i].pairs) {
      EXPECT_TRUE(s >= 0 && s < n1 && t >= 0 && t < n2);
      EXPECT_TRUE(sources.insert(s).second && targets.insert(t).second);
    }
    EXPECT_GE(static_cast<int>(sources.size()), std::min(n1, n2) - 1);
  }
}

TEST(Candidates, AreAllInjectionsWhenThereIsRoom) {
  // Injections of k = min(n1, n2) and, if three pairs are left, of k - 1 tips:
  // C(n1, m) C(n2, m) m! for m pairs.
  const auto count = [](int n1, int n2) {
    return propose(scattered(n1, 1), scattered(n2, 2), {.keep = 100000, .beam = 100000}).size();
  };
  EXPECT_EQ(count(3, 3), 6u);
  EXPECT_EQ(count(4, 4), 24u + 96u);
  EXPECT_EQ(count(5, 5), 120u + 600u);
  EXPECT_EQ(count(5, 4), 120u + 240u);
  EXPECT_EQ(count(4, 5), 120u + 240u);
  EXPECT_EQ(count(1, 3), 3u);
  EXPECT_EQ(count(0, 3), 0u);
}

TEST(Candidates, AreDistinctOneToOneAndSorted) {
  for (const auto& [n1, n2] : {std::pair{5, 5}, {6, 5}, {5, 7}, {2, 2}, {9, 8}, {20, 20}}) {
    const auto list = propose(scattered(n1, 3), scattered(n2, 4));
    EXPECT_LE(list.size(), static_cast<size_t>(ProposalOptions{}.keep));
    EXPECT_FALSE(list.empty());
    expect_well_formed(list, n1, n2);
  }
}

TEST(Candidates, HoldBothClassesInTheirShares) {
  const auto list = propose(scattered(6, 3), scattered(6, 4));
  ASSERT_EQ(list.size(), 150u);
  EXPECT_EQ(
      std::count_if(list.begin(), list.end(), [](const auto& a) { return a.pairs.size() == 6; }),
      60);  // 0.4 of 150
}

TEST(Candidates, ARelabelledCopyComesFirstAtNoCost) {
  for (const int n : {4, 6, 12, 20}) {
    const TipDescriptors tips = scattered(n, 5);
    std::vector<int> order(static_cast<size_t>(n));
    for (int i = 0; i < n; ++i) order[static_cast<size_t>(i)] = (7 * i + 3) % n;
    std::set<int> distinct(order.begin(), order.end());
    ASSERT_EQ(static_cast<int>(distinct.size()), n);
    const auto list = propose(tips, reordered(tips, order));
    EXPECT_NEAR(list[0].cost, 0, 1e-12);  // rounding
    ASSERT_EQ(static_cast<int>(list[0].pairs.size()), n);
    for (const auto& [s, t] : list[0].pairs) EXPECT_EQ(order[static_cast<size_t>(t)], s);
  }
}

TEST(Candidates, LeaveOutAnOutlier) {
  // The target has one tip more, and one of the source's tips has nothing like it there.
  const TipDescriptors source = scattered(6, 6);
  TipDescriptors target = reordered(source, {5, 4, 3, 2, 1, 0});
  for (int i = 1; i < 6; ++i) target.distance(0, i) = target.distance(i, 0) = 9;
  target.signature.row(0).array() += 5;
  const auto list = propose(source, target);
  EXPECT_EQ(list[0].pairs,
            (std::vector<std::pair<int, int>>{{0, 5}, {1, 4}, {2, 3}, {3, 2}, {4, 1}}));
}

TEST(Candidates, SwappingTheSurfacesSwapsThePairs) {
  const auto there = propose(scattered(5, 7), scattered(6, 8), {.keep = 500});
  const auto back = propose(scattered(6, 8), scattered(5, 7), {.keep = 500});
  ASSERT_EQ(there.size(), back.size());
  for (size_t i = 0; i < there.size(); ++i) EXPECT_NEAR(there[i].cost, back[i].cost, 1e-12);
}

TEST(Candidates, KeepFixedTipsTogether) {
  const auto list = propose(scattered(6, 3), scattered(5, 4), {.keep = 1000, .fixed = 2});
  ASSERT_FALSE(list.empty());
  for (const TipAssignment& assignment : list) {
    EXPECT_EQ(assignment.pairs[0], std::pair(0, 0));
    EXPECT_EQ(assignment.pairs[1], std::pair(1, 1));
  }
  expect_well_formed(list, 6, 5);
}

TEST(Candidates, TakeTipsThatAReflectionExchangesToSuch) {
  // The source has two pairs and a tip of its own, the target two pairs, two such tips and one of
  // which nothing is known.
  const std::vector<int> source{1, 0, 3, 2, 4}, target{0, 2, 1, 4, 3, 5, -1};
  const auto list =
      propose(scattered(5, 3),
              scattered(7, 4),
              {.keep = 100000, .source_partner = source, .target_partner = target, .beam = 100000});
  ASSERT_FALSE(list.empty());
  std::set<size_t> sizes;
  for (const TipAssignment& assignment : list) {
    sizes.insert(assignment.pairs.size());
    std::vector<int> image(5, -1);
    for (const auto& [s, t] : assignment.pairs) image[static_cast<size_t>(s)] = t;
    for (size_t s = 0; s < 5; ++s) {
      const int here = image[s], there = image[static_cast<size_t>(source[s])];
      if (here == 6 || there == 6) continue;  // nothing is known
      EXPECT_EQ(there, here < 0 ? -1 : target[static_cast<size_t>(here)]);
    }
  }
  EXPECT_EQ(sizes, (std::set<size_t>{3, 4, 5}));
}

TEST(Candidates, OfADeformedCreatureHoldTheTruthEarly) {
  const TriangleMesh a = shapes::creature(3), b = shapes::creature(3, 1.25);
  const ShapeFeatures source = compute_features(a).value(), target = compute_features(b).value();
  ASSERT_EQ(source.tips.size(), target.tips.size());
  const auto list = propose(tip_descriptors(source), tip_descriptors(target));
  const auto right = std::find_if(list.begin(), list.end(), [&](const TipAssignment& assignment) {
    return std::all_of(assignment.pairs.begin(), assignment.pairs.end(), [&](const auto& pair) {
      const Vector3d p = a.position(source.tips[static_cast<size_t>(pair.first)].vertex);
      const Vector3d q = b.position(target.tips[static_cast<size_t>(pair.second)].vertex);
      return (p.normalized() - q.normalized()).norm() < 0.3;
    });
  });
  EXPECT_LT(right - list.begin(), 10);
}

}  // namespace
}  // namespace crosspatch
