#include "core/order_correction.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "core/creatures.hpp"

namespace crosspatch {
namespace {

FeatureGraph creature_graph() {
  const TriangleMesh mesh = shapes::creature(3);
  const ShapeFeatures features = compute_features(mesh).value();
  return build_feature_graph(mesh,
                             features.log_adf.array().exp(),
                             features.spectrum.values[1],
                             {.complex = {.threshold = 0.02}})
      .value();
}

std::vector<int> identity(const FeatureGraph& graph) {
  std::vector<int> partner(static_cast<size_t>(graph.node_count()));
  std::iota(partner.begin(), partner.end(), 0);
  return partner;
}

TEST(OrderCorrection, LeavesTheIdentityAlone) {
  const FeatureGraph graph = creature_graph();
  std::vector<int> partner = identity(graph);
  const Eigen::MatrixXd score = Eigen::MatrixXd::Identity(graph.node_count(), graph.node_count());
  EXPECT_TRUE(wrongly_ordered(graph, graph, partner).empty());
  EXPECT_EQ(correct_order(graph, graph, score, partner), 0);
  EXPECT_EQ(partner, identity(graph));
}

TEST(OrderCorrection, UndoesASwapThatBreaksACyclicOrder) {
  const FeatureGraph graph = creature_graph();
  const Eigen::MatrixXd score =
      Eigen::MatrixXd::Constant(graph.node_count(), graph.node_count(), 0.1) +
      Eigen::MatrixXd(Eigen::MatrixXd::Identity(graph.node_count(), graph.node_count()));
  int tried = 0;
  for (int i = 0; i < graph.node_count(); ++i)
    for (int j = 0; j < i; ++j) {
      if (graph.node(i).kind != NodeKind::kSaddle || graph.node(j).kind != NodeKind::kSaddle)
        continue;
      std::vector<int> partner = identity(graph);
      std::swap(partner[static_cast<size_t>(i)], partner[static_cast<size_t>(j)]);
      if (wrongly_ordered(graph, graph, partner).empty()) continue;
      ++tried;
      EXPECT_GT(correct_order(graph, graph, score, partner), 0);
      EXPECT_EQ(partner, identity(graph)) << "saddles " << i << " and " << j;
    }
  EXPECT_GT(tried, 0);
}

TEST(OrderCorrection, KeepsPartnersOneToOneAndOfOneKind) {
  const FeatureGraph graph = creature_graph();
  const int n = graph.node_count();
  for (int seed = 1; seed < 6; ++seed) {
    // Maxima, saddles and minima are stored in runs: turn each run.
    std::vector<int> partner = identity(graph);
    const int maxima = graph.complex.count(NodeKind::kMaximum);
    const int saddles = graph.complex.count(NodeKind::kSaddle);
    std::rotate(partner.begin(), partner.begin() + seed % maxima, partner.begin() + maxima);
    std::rotate(partner.begin() + maxima,
                partner.begin() + maxima + (2 * seed) % saddles,
                partner.begin() + maxima + saddles);
    correct_order(graph, graph, Eigen::MatrixXd::Ones(n, n), partner);
    std::vector<int> sorted = partner;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, identity(graph));
    for (int i = 0; i < n; ++i)
      EXPECT_EQ(graph.node(i).kind, graph.node(partner[static_cast<size_t>(i)]).kind);
  }
}

}  // namespace
}  // namespace crosspatch
