#include "core/discrete_gradient.hpp"

#include <gtest/gtest.h>

#include "core/morse_fields.hpp"

namespace crosspatch {
namespace {

TEST(DiscreteGradient, IsValidOnAllFields) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    const auto gradient = discrete_gradient(field.mesh, field.values);
    ASSERT_TRUE(gradient) << field.name;
    EXPECT_TRUE(validate(*gradient)) << field.name << ": " << validate(*gradient).error().message;
  }
}

TEST(DiscreteGradient, CriticalCellsAreThoseOfTheOneRings) {
  // On a closed mesh a vertex is a minimum (maximum) if all neighbours are higher (lower); a vertex
  // whose ring changes sign 2 m times is the top of m - 1 saddles. Banchoff's index.
  for (const shapes::Field& field : shapes::morse_fields()) {
    if (!boundary_loops(field.mesh).empty()) continue;
    const DiscreteGradient gradient = discrete_gradient(field.mesh, field.values).value();
    size_t minima = 0, maxima = 0, saddles = 0;
    for (int v = 0; v < field.mesh.vertex_count(); ++v) {
      std::vector<bool> lower;
      for_each_outgoing(field.mesh, v, [&](int h) {
        const int u = field.mesh.to(h);
        lower.push_back(std::pair(field.values[u], u) < std::pair(field.values[v], v));
      });
      size_t changes = 0;
      for (size_t i = 0; i < lower.size(); ++i)
        changes += lower[i] != lower[(i + 1) % lower.size()];
      if (changes == 0) ++(lower[0] ? maxima : minima);
      if (changes > 2) saddles += changes / 2 - 1;
    }
    EXPECT_EQ(gradient.minima.size(), minima) << field.name;
    EXPECT_EQ(gradient.saddles.size(), saddles) << field.name;
    EXPECT_EQ(gradient.maxima.size(), maxima) << field.name;
  }
}

TEST(DiscreteGradient, PathsOfTheForestsAreMonotone) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    const DiscreteGradient gradient = discrete_gradient(field.mesh, field.values).value();
    const GradientForests roots = forests(gradient);
    for (const int h : roots.down) {
      if (h < 0) continue;
      EXPECT_LT(gradient.rank[static_cast<size_t>(gradient.surface.to(h))],
                gradient.rank[static_cast<size_t>(gradient.surface.from(h))])
          << field.name;
    }
  }
}

TEST(DiscreteGradient, RefusesBadFields) {
  const TriangleMesh mesh = shapes::tetrahedron();
  EXPECT_FALSE(discrete_gradient(mesh, Eigen::VectorXd::Zero(3)));
  const auto nan = discrete_gradient(mesh, Eigen::Vector4d(0, 1, std::nan(""), 2));
  ASSERT_FALSE(nan);
  EXPECT_EQ(nan.error().message, "field: value nan at vertex 2 is not finite");
}

}  // namespace
}  // namespace crosspatch
