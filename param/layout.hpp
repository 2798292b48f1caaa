#pragma once

#include <optional>
#include <vector>

#include "core/persistence.hpp"

namespace crosspatch {

/// A critical point as a node of a layout.
struct LayoutNode {
  NodeKind kind = NodeKind::kMinimum;
  int cell = -1;      ///< of the gradient's surface: vertex, lower half-edge of the edge, or face
  double value = 0;   ///< of the function, at the highest vertex of the cell
  bool free = false;  ///< true where nothing says what the node corresponds to
};

/// The quadrangular cells of a Morse-Smale complex as a rotation system of darts.
///
/// Arc a has the darts 2 a, which leaves its saddle, and 2 a + 1, which leaves its extremum. Saddle
/// number s (they come first among the nodes) has the arcs 4 s .. 4 s + 3, counter-clockwise, even
/// ones descending. Two arcs may join the same nodes, both sides of an arc may lie in one cell, and
/// a node may have any number of darts from one.
///
/// Invariants: (1) sigma permutes the darts and its cycles are the darts of each node, so that
/// every node has one; (2) phi(d) = sigma^-1(twin d); (3) face labels the cycles of phi, 0 ..
/// face_count - 1 by first dart; (4) every cycle of phi has four darts; (5) there are twice as many
/// faces as saddles; (6) nodes - arcs + faces is the Euler characteristic of the surface.
struct QuadLayout {
  std::vector<LayoutNode> nodes;  ///< saddles, minima, maxima
  /// Per node: the dart that a walk around the gradient's tree, from its root, meets first.
  std::vector<int> first_dart;
  std::vector<int> node;   ///< per dart: where it starts
  std::vector<int> sigma;  ///< per dart: next counter-clockwise around its node
  std::vector<int> phi;    ///< per dart: next around the face on its left
  std::vector<int> face;   ///< per dart: the face on its left
  int face_count = 0;

  [[nodiscard]] int arc_count() const { return static_cast<int>(node.size()) / 2; }
  [[nodiscard]] int saddle_count() const { return arc_count() / 4; }
  [[nodiscard]] static int twin(int dart) { return dart ^ 1; }
};

/// The layout of the Morse-Smale complex of `gradient`. kNoCorrespondence if an extremum has no
/// arc, as on a sphere without saddles: there is nothing to cut along.
Result<QuadLayout> quad_layout(const DiscreteGradient& gradient);

/// Checks the invariants of QuadLayout against the Euler characteristic of the surface.
Status validate(const QuadLayout& layout, int euler);

/// The four darts around `face`, starting at the lowest.
std::vector<int> darts_of_face(const QuadLayout& layout, int face);

/// A node to be kept: kind, and the mesh vertex that MorseNode gives for it.
struct KeptNode {
  NodeKind kind = NodeKind::kMaximum;
  int vertex = -1;
};

/// Cancels every saddle that is not kept with an extremum that is not kept either, cheapest
/// difference of values (on `scale`) first, as long as there is one and another saddle is left.
/// What is left besides the kept nodes cannot be cancelled. kBadInput if a kept node is none of the
/// gradient's, or the values do not fit the scale. Source: Feng et al. 2013, Sec. 6 (pruning of
/// unmatched points).
Result<DiscreteGradient> prune_to(DiscreteGradient gradient,
                                  const std::vector<KeptNode>& kept,
                                  FieldScale scale = FieldScale::kLog);

/// Marks as free the nodes of `layout`, made of `gradient`, that are not among `kept`.
void mark_free_nodes(QuadLayout& layout,
                     const DiscreteGradient& gradient,
                     const std::vector<KeptNode>& kept);

}  // namespace crosspatch
