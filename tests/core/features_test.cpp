#include "core/features.hpp"

#include <gtest/gtest.h>

#include "core/creatures.hpp"
#include "core/geodesics.hpp"

namespace crosspatch {
namespace {

TEST(Features, TipsOfACreatureAreTheEndsOfItsLimbs) {
  const ShapeFeatures features = compute_features(shapes::creature(3)).value();
  ASSERT_EQ(features.tips.size(), shapes::limb_directions().size());
  for (const Vector3d& limb : shapes::limb_directions()) {
    double nearest = 10;
    for (const Tip& tip : features.tips)
      nearest = std::min(
          nearest,
          (shapes::creature(3).position(tip.vertex).normalized() - limb.normalized()).norm());
    EXPECT_LT(nearest, 0.2);  // about an edge of the mesh
  }
}

TEST(Features, TipsAreSortedAndDistancesBelongToThem) {
  const TriangleMesh mesh = shapes::creature(3);
  const ShapeFeatures features = compute_features(mesh).value();
  EXPECT_EQ(features.tips.front().persistence, 1);
  for (size_t i = 0; i < features.tips.size(); ++i) {
    if (i > 0) {
      EXPECT_LE(features.tips[i].persistence, features.tips[i - 1].persistence);
    }
    EXPECT_GE(features.tips[i].persistence, 0.02);
    EXPECT_EQ(features.tips[i].log_adf, features.log_adf[features.tips[i].vertex]);
    EXPECT_EQ(features.tip_distances(features.tips[i].vertex, static_cast<Eigen::Index>(i)), 0);
  }
  EXPECT_EQ(features.log_hks.rows(), mesh.vertex_count());
  EXPECT_EQ(features.wks.rows(), mesh.vertex_count());
}

TEST(Features, ExtremitiesBeginWithTheTips) {
  const ShapeFeatures features = compute_features(shapes::creature(3)).value();
  ASSERT_GE(features.extremities.size(), features.tips.size());
  ASSERT_EQ(features.extremity_distances.cols(),
            static_cast<Eigen::Index>(features.extremities.size()));
  for (size_t i = 0; i < features.extremities.size(); ++i) {
    const int vertex = features.extremities[i].vertex;
    if (i < features.tips.size()) {
      EXPECT_EQ(vertex, features.tips[i].vertex);
    }
    EXPECT_GE(features.extremities[i].persistence, 0.003);
    EXPECT_EQ(features.extremity_distances(vertex, static_cast<Eigen::Index>(i)), 0);
  }
}

TEST(Features, DoNotDependOnScaleRotationOrVertexNumbers) {
  const TriangleMesh mesh = shapes::creature(3);
  const int n = mesh.vertex_count();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).matrix();
  MatrixX3d V(n, 3);
  for (int v = 0; v < n; ++v) V.row(n - 1 - v) = (7 * R * mesh.position(v)).transpose();
  const TriangleMesh moved = make_mesh(V, (n - 1 - mesh.F.array()).matrix()).value();
  const ShapeFeatures a = compute_features(mesh).value(), b = compute_features(moved).value();
  ASSERT_EQ(a.tips.size(), b.tips.size());
  for (size_t i = 0; i < a.tips.size(); ++i) {
    EXPECT_EQ(a.tips[i].vertex, n - 1 - b.tips[i].vertex);
    EXPECT_NEAR(a.tips[i].persistence, b.tips[i].persistence, 1e-6);  // solver tolerance
  }
  EXPECT_LT((a.tip_distances - b.tip_distances.colwise().reverse()).norm(), 1e-9);  // rounding
}

TEST(Features, TakeLandmarksForTheTipsNextToThem) {
  const TriangleMesh mesh = shapes::creature(3);
  const ShapeFeatures features = compute_features(mesh).value();
  const int tip = features.tips[1].vertex;
  int beside = -1;
  for_each_outgoing(mesh, tip, [&](int h) { beside = mesh.to(h); });
  const double edge = geodesic_distances(mesh, {tip})(beside, 0) / std::sqrt(total_area(mesh));
  const ShapeFeatures joined = with_landmarks(mesh, features, {beside}, 2 * edge);
  ASSERT_EQ(joined.tips.size(), features.tips.size());
  EXPECT_EQ(joined.tips[0].vertex, beside);
  for (size_t i = 0; i < joined.tips.size(); ++i) {
    EXPECT_NE(joined.tips[i].vertex, tip);
    EXPECT_EQ(joined.tip_distances(joined.tips[i].vertex, static_cast<Eigen::Index>(i)), 0);
  }
}

TEST(Features, RefuseATriangle) {
  MatrixX3d V(3, 3);
  V << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  MatrixX3i F(1, 3);
  F << 0, 1, 2;
  const auto features = compute_features(make_mesh(V, F).value());
  ASSERT_FALSE(features);
  EXPECT_EQ(features.error().message, "mesh: 3 vertices, at least 4 are needed");
}

}  // namespace
}  // namespace crosspatch
