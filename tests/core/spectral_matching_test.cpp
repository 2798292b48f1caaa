#include "core/spectral_matching.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/creatures.hpp"

namespace crosspatch {
namespace {

const TriangleMesh& creature_mesh(double stretch) {
  static const TriangleMesh one = shapes::creature(3), longer = shapes::creature(3, 1.05);
  return stretch == 1 ? one : longer;
}

const MatchingShape& creature(double stretch) {
  const auto make = [](double s) {
    return matching_shape(creature_mesh(s), compute_features(creature_mesh(s)).value()).value();
  };
  static const MatchingShape one = make(1), longer = make(1.05);
  return stretch == 1 ? one : longer;
}

std::vector<SpectralMatchingOptions> all_options() {
  std::vector<SpectralMatchingOptions> list;
  for (const auto constraint :
       {PairConstraint::kConnectivity, PairConstraint::kGeodesic, PairConstraint::kDiffusion})
    for (const auto signature : {NodeSignature::kAutoDiffusion, NodeSignature::kHeatKernel})
      for (const bool correct : {false, true})
        list.push_back(
            {.constraint = constraint, .signature = signature, .order_correction = correct});
  list.push_back({.method = MatchMethod::kHungarian});
  list.push_back({.method = MatchMethod::kHungarian, .signature = NodeSignature::kHeatKernel});
  return list;
}

TEST(SpectralMatching, PrincipalEigenvectorSolvesItsEquation) {
  Eigen::MatrixXd M(4, 4);  // a bipartite square: eigenvalues +2 and -2
  M << 0, 1, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1, 0;
  M(0, 0) = 0.3;
  const Eigen::VectorXd x = principal_eigenvector(M);
  EXPECT_EQ(x.maxCoeff(), 1);
  EXPECT_GE(x.minCoeff(), 0);
  const double lambda = x.dot(M * x) / x.squaredNorm();
  EXPECT_LT((M * x - lambda * x).norm(), 1e-9);  // stop of the iteration
  EXPECT_GT(lambda, 2);
}

TEST(SpectralMatching, ScoreMatrixWeighsNodesAndPairsAndExcludesRivals) {
  const MatchingShape& shape = creature(1);
  const std::vector<NodePair> pairs{{0, 0, 1}, {1, 1, 0.5}, {0, 1, 0.25}};
  const Eigen::MatrixXd M =
      score_matrix(shape, shape, pairs, {.constraint = PairConstraint::kGeodesic, .alpha = 0.2});
  EXPECT_EQ(M, M.transpose());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(M(i, i), 0.2 * pairs[static_cast<size_t>(i)].score);
  EXPECT_EQ(M(0, 1), 0.8);  // Eq. (4) of equal distances is 1
  EXPECT_EQ(M(0, 2), 0);    // one source node
  EXPECT_EQ(M(1, 2), 0);    // one target node
}

TEST(SpectralMatching, NodeScoresAreOneOnTheDiagonalAndZeroAcrossKinds) {
  const MatchingShape& shape = creature(1);
  for (const auto signature : {NodeSignature::kAutoDiffusion, NodeSignature::kHeatKernel}) {
    const Eigen::MatrixXd H = node_scores(shape, shape, signature);
    EXPECT_EQ(H, H.transpose());
    EXPECT_GE(H.minCoeff(), 0);
    for (int i = 0; i < H.rows(); ++i) {
      EXPECT_EQ(H(i, i), 1);
      for (int j = 0; j < H.cols(); ++j) {
        if (shape.graph.node(i).kind != shape.graph.node(j).kind) {
          EXPECT_EQ(H(i, j), 0);
        }
      }
    }
  }
}

TEST(SpectralMatching, AShapeMatchesItself) {
  const int n = creature_mesh(1).vertex_count();
  for (const SpectralMatchingOptions& options : all_options()) {
    const Matching matching = spectral_matching(creature(1), creature(1), options).value();
    EXPECT_TRUE(validate(matching, n, n)) << validate(matching, n, n).error().message;
    size_t same = 0;
    for (const Match& m : matching.matches) same += m.source_vertex == m.target_vertex;
    // The direct methods must find every node; the spectral ones may confuse look-alike saddles.
    if (options.method == MatchMethod::kHungarian) {
      EXPECT_EQ(same, matching.matches.size());
    }
    EXPECT_GE(4 * same, 3 * matching.matches.size());
  }
}

TEST(SpectralMatching, BackwardsIsTheInverse) {
  for (SpectralMatchingOptions options : all_options()) {
    options.order_correction = false;  // it visits the nodes of the first surface
    const auto there = spectral_matching(creature(1), creature(1.05), options).value();
    const auto back = spectral_matching(creature(1.05), creature(1), options).value();
    std::set<std::pair<int, int>> pairs, inverse;
    for (const Match& m : there.matches) pairs.emplace(m.source_vertex, m.target_vertex);
    for (const Match& m : back.matches) inverse.emplace(m.target_vertex, m.source_vertex);
    EXPECT_EQ(pairs, inverse);
  }
}

TEST(SpectralMatching, LimbsOfDifferentLengthsAreFound) {
  const TriangleMesh a = shapes::creature(3, 1, shapes::uneven_limbs());
  const TriangleMesh b = shapes::creature(3, 1.05, shapes::uneven_limbs());
  const auto shape = [](const TriangleMesh& mesh) {
    return matching_shape(mesh, compute_features(mesh).value()).value();
  };
  const MatchingShape source = shape(a), target = shape(b);
  for (SpectralMatchingOptions options : all_options()) {
    options.order_correction = false;
    const Matching matching = spectral_matching(source, target, options).value();
    int tips = 0, right = 0;
    for (const Match& m : matching.matches) {
      if (m.kind != NodeKind::kMaximum) continue;
      ++tips;
      right += (a.position(m.source_vertex).normalized() - b.position(m.target_vertex).normalized())
                   .norm() < 0.3;
    }
    EXPECT_GE(tips, 5);
    EXPECT_GE(right + 2, tips);  // two limbs of similar value may be exchanged
  }
}

TEST(SpectralMatching, LowMatchesAreRemovedOnDemand) {
  const auto all = spectral_matching(creature(1), creature(1), {.least_value = 0}).value();
  const auto high = spectral_matching(creature(1), creature(1), {.least_value = 0.5}).value();
  EXPECT_LT(high.matches.size(), all.matches.size());
  for (const Match& m : high.matches) EXPECT_NE(m.kind, NodeKind::kMinimum);
}

TEST(SpectralMatching, SaysWhenNothingIsLeft) {
  const auto matching = spectral_matching(creature(1), creature(1.05), {.epsilon = 1.01});
  ASSERT_FALSE(matching);
  EXPECT_EQ(matching.error().code, ErrorCode::kNoCorrespondence);
}

TEST(Matching, ValidateNamesARepeatedVertex) {
  const Matching twice{{{NodeKind::kMaximum, 1, 2, 0.9}, {NodeKind::kMaximum, 3, 2, 0.8}}};
  EXPECT_EQ(validate(twice, 9, 9).error().message, "match 3 -> 2: matched twice");
  EXPECT_EQ(name(NodeKind::kSaddle), "saddle");
}

}  // namespace
}  // namespace crosspatch
