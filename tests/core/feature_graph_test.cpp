#include "core/feature_graph.hpp"

#include <gtest/gtest.h>

#include "core/creatures.hpp"
#include "core/heat_flow.hpp"
#include "core/morse_fields.hpp"

namespace crosspatch {
namespace {

TEST(HeatFlow, KeepsTheMeanAndShrinksTheRange) {
  const TriangleMesh mesh = shapes::torus(3, 1, 30, 12);
  const Laplacian laplacian = compute_laplacian(mesh).value();
  const auto series = heat_flow_series(mesh, shapes::noise(mesh, 1), 0.01, 6).value();
  for (int k = 1; k < 6; ++k) {
    const double mean = laplacian.mass.dot(series.col(0));
    EXPECT_NEAR(laplacian.mass.dot(series.col(k)), mean, 1e-10 * mean);  // rounding
    // The maximum principle, which the intrinsic Delaunay weights guarantee.
    EXPECT_LE(series.col(k).maxCoeff(), series.col(k - 1).maxCoeff() + 1e-12);
    EXPECT_GE(series.col(k).minCoeff(), series.col(k - 1).minCoeff() - 1e-12);
  }
}

TEST(FeatureGraph, IsValidOnAllFields) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    const auto graph =
        build_feature_graph(field.mesh, field.values, 20, {.complex = {.threshold = 0.2}});
    ASSERT_TRUE(graph) << field.name;
    EXPECT_TRUE(validate(*graph)) << field.name << ": " << validate(*graph).error().message;
  }
}

TEST(FeatureGraph, FurtherArcsOfTheFirstLevelRiseMonotonically) {
  const shapes::Field field{"", shapes::icosphere(3), shapes::noise(shapes::icosphere(3), 5)};
  const auto graph =
      build_feature_graph(field.mesh, field.values, 20, {.complex = {.threshold = 0.3}}).value();
  int further = 0;
  for (size_t a = graph.complex.arcs.size(); a < graph.arcs.size(); ++a) {
    const FeatureArc& arc = graph.arcs[a];
    if (arc.weight < 1) continue;
    ++further;
    const double sign = graph.node(arc.extremum).kind == NodeKind::kMaximum ? 1 : -1;
    EXPECT_EQ(arc.path.front(), graph.node(arc.saddle).vertex);
    EXPECT_EQ(arc.path.back(), graph.node(arc.extremum).vertex);
    for (size_t i = 1; i < arc.path.size(); ++i) {
      EXPECT_GE(find_halfedge(field.mesh, arc.path[i - 1], arc.path[i]), 0);
      EXPECT_GT(sign * field.values[arc.path[i]], sign * field.values[arc.path[i - 1]]);
    }
  }
  EXPECT_GT(further, 0);
}

TEST(FeatureGraph, OfACreatureJoinsSaddlesToOtherTips) {
  const TriangleMesh mesh = shapes::creature(3);
  const ShapeFeatures features = compute_features(mesh).value();
  const auto graph = build_feature_graph(mesh,
                                         features.log_adf.array().exp(),
                                         features.spectrum.values[1],
                                         {.complex = {.threshold = 0.02}})
                         .value();
  EXPECT_TRUE(validate(graph)) << validate(graph).error().message;
  EXPECT_EQ(graph.complex.count(NodeKind::kMaximum), 6);
  const Eigen::MatrixXd W = adjacency(graph);
  EXPECT_EQ(W, W.transpose());
  EXPECT_LE(W.maxCoeff(), 1);
}

}  // namespace
}  // namespace crosspatch
