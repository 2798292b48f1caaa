#include "param/layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/morse_fields.hpp"
#include "core/morse_smale.hpp"

namespace crosspatch {
namespace {

DiscreteGradient simplified(const shapes::Field& field, double threshold) {
  auto gradient = discrete_gradient(field.mesh, field.values).value();
  const auto hierarchy = persistence_hierarchy(gradient, FieldScale::kLinear).value();
  return simplify(std::move(gradient), hierarchy, threshold);
}

TEST(QuadLayout, IsValidOnAllFieldsThatHaveSaddles) {
  int layouts = 0;
  for (const shapes::Field& field : shapes::morse_fields())
    for (const double threshold : {0.0, 0.1, 0.5}) {
      const DiscreteGradient gradient = simplified(field, threshold);
      const auto layout = quad_layout(gradient);
      ASSERT_EQ(layout.has_value(), !gradient.saddles.empty()) << field.name;
      if (!layout) continue;
      ++layouts;
      const Status valid = validate(*layout, shapes::closed_euler(field.mesh));
      EXPECT_TRUE(valid) << field.name << " at " << threshold << ": " << valid.error().message;
    }
  EXPECT_GT(layouts, 40);
}

TEST(QuadLayout, HasTheCellsOfTheMorseSmaleComplex) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    const DiscreteGradient gradient = simplified(field, 0.05);
    if (gradient.saddles.empty()) continue;
    const auto hierarchy = persistence_hierarchy(gradient, FieldScale::kLinear).value();
    const auto complex = morse_smale_complex(gradient, hierarchy);
    const QuadLayout layout = quad_layout(gradient).value();
    // Cells as sorted lists of the values of their nodes, which are told apart by it.
    const auto sorted = [](std::vector<std::array<double, 4>> cells) {
      for (auto& cell : cells) std::sort(cell.begin(), cell.end());
      std::sort(cells.begin(), cells.end());
      return cells;
    };
    std::vector<std::array<double, 4>> expected, found;
    for (const MorseCell& cell : complex.cells) {
      auto& values = expected.emplace_back();
      for (size_t k = 0; k < 4; ++k)
        values[k] = complex.nodes[static_cast<size_t>(cell.nodes[k])].value;
    }
    for (int f = 0; f < layout.face_count; ++f) {
      auto& values = found.emplace_back();
      const std::vector<int> darts = darts_of_face(layout, f);
      for (size_t k = 0; k < 4; ++k)
        values[k] =
            layout.nodes[static_cast<size_t>(layout.node[static_cast<size_t>(darts[k])])].value;
    }
    EXPECT_EQ(sorted(found), sorted(expected)) << field.name;
  }
}

TEST(QuadLayout, BrokenRotationIsNamed) {
  const shapes::Field field = shapes::morse_fields()[9];
  QuadLayout layout = quad_layout(simplified(field, 0)).value();
  EXPECT_FALSE(validate(layout, 5));
  std::swap(layout.sigma[0], layout.sigma[2]);
  EXPECT_FALSE(validate(layout, shapes::closed_euler(field.mesh)));
}

/// Kept nodes for some extrema and saddles of a gradient, as the Morse-Smale complex names them.
std::vector<KeptNode> some_nodes(const DiscreteGradient& gradient, size_t every) {
  std::vector<KeptNode> kept;
  for (size_t i = 0; i < gradient.maxima.size(); i += every)
    kept.push_back({NodeKind::kMaximum, highest_corner(gradient, gradient.maxima[i])});
  for (size_t i = 0; i < gradient.minima.size(); i += every)
    kept.push_back({NodeKind::kMinimum, gradient.minima[i]});
  for (size_t i = 0; i < gradient.saddles.size(); i += 4 * every)
    kept.push_back({NodeKind::kSaddle, highest_end(gradient, gradient.saddles[i])});
  return kept;
}

TEST(Pruning, KeepsTheKeptAndTheEulerSum) {
  for (const shapes::Field& field : shapes::morse_fields()) {
    if (!boundary_loops(field.mesh).empty()) continue;
    const DiscreteGradient gradient = simplified(field, 0.05);
    if (gradient.saddles.size() < 8) continue;
    const std::vector<KeptNode> kept = some_nodes(gradient, 3);
    const auto pruned = prune_to(gradient, kept, FieldScale::kLinear);
    ASSERT_TRUE(pruned) << pruned.error().message;
    EXPECT_TRUE(validate(*pruned)) << field.name;
    EXPECT_LT(pruned->saddles.size(), gradient.saddles.size());
    auto layout = quad_layout(*pruned).value();
    EXPECT_TRUE(validate(layout, euler_characteristic(field.mesh)));
    mark_free_nodes(layout, *pruned, kept);
    const auto held = std::count_if(
        layout.nodes.begin(), layout.nodes.end(), [](const LayoutNode& n) { return !n.free; });
    EXPECT_GE(held, static_cast<long>(kept.size())) << field.name;  // twins share a vertex
  }
}

TEST(Pruning, WithoutKeptNodesLeavesTheFewestPossible) {
  // One minimum, one maximum and 2 g saddles; on a sphere one pair more, as a layout needs a
  // saddle.
  for (const auto& [mesh, saddles] :
       {std::pair{shapes::icosphere(3), 1}, std::pair{shapes::torus(3, 1, 24, 12), 2}}) {
    const auto gradient = discrete_gradient(mesh, shapes::noise(mesh, 7)).value();
    const auto pruned = prune_to(gradient, {}, FieldScale::kLog).value();
    EXPECT_EQ(static_cast<int>(pruned.saddles.size()), saddles);
    EXPECT_TRUE(validate(quad_layout(pruned).value(), euler_characteristic(mesh)));
  }
}

TEST(Pruning, UnknownNodesAndBadScalesAreNamed) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const auto gradient = discrete_gradient(mesh, mesh.V.col(0)).value();
  EXPECT_EQ(prune_to(gradient, {{NodeKind::kMaximum, 100000}}).error().message,
            "layout: vertex 100000 is no node of the kind to be kept");
  EXPECT_EQ(prune_to(gradient, {}, FieldScale::kLog).error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace crosspatch
