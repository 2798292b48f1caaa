#include "core/persistence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "core/morse_fields.hpp"

namespace crosspatch {
namespace {

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Persistence of the components of the sublevel sets by the elder rule on vertices: an independent
/// way to the min-saddle pairs. Sorted, without pairs of one vertex.
std::vector<double> elder_rule(const TriangleMesh& mesh,
                               const Eigen::VectorXd& values,
                               double sign) {
  std::vector<int> order(at(mesh.vertex_count()));
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int v) { return std::pair(sign * values[v], sign * v); };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<int> root(order.size(), -1);
  const auto find = [&](int v) {
    while (root[at(v)] != v) v = root[at(v)];
    return v;
  };
  std::vector<double> pairs;
  for (const int v : order) {
    root[at(v)] = v;
    for_each_outgoing(mesh, v, [&](int h) {
      if (root[at(mesh.to(h))] < 0) return;
      int a = find(mesh.to(h)), b = find(v);
      if (a == b) return;
      if (key(a) < key(b)) std::swap(a, b);  // a is the younger
      if (a != v) pairs.push_back(std::abs(values[v] - values[a]));
      root[at(a)] = b;
    });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(Persistence, CancellationOnSpheresGivesThePairsOfTheElderRule) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    if (shapes::closed_euler(field.mesh) != 2 || !boundary_loops(field.mesh).empty()) continue;
    const auto gradient = discrete_gradient(field.mesh, field.values).value();
    const auto hierarchy = persistence_hierarchy(gradient, FieldScale::kLinear).value();
    std::vector<double> with_minima, with_maxima;
    for (const Cancellation& c : hierarchy.order)
      (c.kind == NodeKind::kMinimum ? with_minima : with_maxima)
          .push_back(c.persistence * (hierarchy.range > 0 ? hierarchy.range : 1));
    const auto expect_equal = [&](const std::vector<double>& a, const std::vector<double>& b) {
      ASSERT_EQ(a.size(), b.size()) << field.name;
      for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << field.name;
    };
    expect_equal(with_minima, elder_rule(field.mesh, field.values, 1));
    expect_equal(with_maxima, elder_rule(field.mesh, field.values, -1));
  }
}

TEST(Persistence, HierarchyRisesAndEndsWithTheTopology) {
  for (const shapes::Field& field : shapes::morse_fields())
    for (const FieldScale scale : {FieldScale::kLinear, FieldScale::kLog}) {
      const auto gradient = discrete_gradient(field.mesh, field.values).value();
      const auto hierarchy = persistence_hierarchy(gradient, scale).value();
      std::set<int> saddles;
      double last = 0;
      for (const Cancellation& c : hierarchy.order) {
        EXPECT_GE(c.persistence, last) << field.name;
        EXPECT_TRUE(saddles.insert(c.saddle).second) << field.name;
        last = c.persistence;
      }
      EXPECT_LE(last, 1) << field.name;
      const DiscreteGradient bare = simplify(gradient, hierarchy, 2);
      EXPECT_EQ(bare.minima.size(), 1u) << field.name;
      EXPECT_EQ(bare.maxima.size(), 1u) << field.name;
      EXPECT_EQ(static_cast<int>(bare.saddles.size()), 2 - shapes::closed_euler(field.mesh));
    }
}

TEST(Persistence, EverySimplifiedGradientIsValid) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    const auto gradient = discrete_gradient(field.mesh, field.values).value();
    const auto hierarchy = persistence_hierarchy(gradient, FieldScale::kLog).value();
    for (const double threshold : {0.0, 0.01, 0.1, 0.5, 1.0}) {
      const Status valid = validate(simplify(gradient, hierarchy, threshold));
      EXPECT_TRUE(valid) << field.name << " at " << threshold << ": " << valid.error().message;
    }
  }
}

TEST(Persistence, RefusesLogarithmsOfNegativeValues) {
  const TriangleMesh mesh = shapes::icosphere(1);
  const auto gradient = discrete_gradient(mesh, mesh.V.col(2)).value();
  const auto hierarchy = persistence_hierarchy(gradient, FieldScale::kLog);
  ASSERT_FALSE(hierarchy);
  EXPECT_EQ(hierarchy.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace crosspatch
