#include "core/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

namespace crosspatch {
namespace {

double total(const Eigen::MatrixXd& cost, const std::vector<int>& columns) {
  double sum = 0;
  std::set<int> used;
  for (int i = 0; i < cost.rows(); ++i) {
    const int j = columns[static_cast<size_t>(i)];
    if (j < 0) continue;
    EXPECT_TRUE(used.insert(j).second);
    sum += cost(i, j);
  }
  EXPECT_EQ(static_cast<long>(used.size()), std::min(cost.rows(), cost.cols()));
  return sum;
}

double best_by_trying_all(const Eigen::MatrixXd& cost) {
  if (cost.rows() > cost.cols()) return best_by_trying_all(cost.transpose());
  std::vector<int> order(static_cast<size_t>(cost.cols()));
  std::iota(order.begin(), order.end(), 0);
  double best = 1e300;
  do {
    double sum = 0;
    for (int i = 0; i < cost.rows(); ++i) sum += cost(i, order[static_cast<size_t>(i)]);
    best = std::min(best, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(Assignment, IsTheCheapestOfAll) {
  std::mt19937 random(1);
  for (int round = 0; round < 60; ++round) {
    Eigen::MatrixXd cost(1 + round % 6, 1 + round / 10);
    // Small integers, negative ones too: many ties, and exact sums.
    for (double& c : cost.reshaped()) c = static_cast<double>(random() % 9) - 2;
    EXPECT_EQ(total(cost, least_cost_assignment(cost)), best_by_trying_all(cost));
  }
}

TEST(Assignment, OfNothingIsEmpty) {
  EXPECT_TRUE(least_cost_assignment(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(least_cost_assignment(Eigen::MatrixXd(2, 0)), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace crosspatch
