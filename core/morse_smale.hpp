#pragma once

#include <array>
#include <limits>

#include "core/persistence.hpp"

namespace crosspatch {

/// A critical point.
struct MorseNode {
  NodeKind kind = NodeKind::kMinimum;
  int vertex = -1;   ///< of the mesh: the minimum, a saddle edge's or maximum face's highest vertex
  double value = 0;  ///< of the function there
  double persistence = std::numeric_limits<double>::infinity();  ///< at which it would be cancelled
  std::vector<int> arcs;  ///< counter-clockwise around the node
};

/// A separatrix from a saddle to an extremum.
struct MorseArc {
  int saddle = -1;
  int extremum = -1;
  /// Vertices from the saddle's to the extremum's, each next to the one before, none twice. On a
  /// mesh with boundary a path may jump along a boundary loop. Paths may touch and overlap.
  std::vector<int> path;
};

/// A region without critical points inside. Corner i is nodes[i]; side i, arcs[i], leads from it to
/// nodes[(i + 1) % 4]; counter-clockwise, starting with a saddle followed by a maximum.
struct MorseCell {
  std::array<int, 4> nodes{};
  std::array<int, 4> arcs{};
};

/// The Morse-Smale complex of a function on a closed surface (boundary loops closed by cones).
///
/// Invariants: (1) #minima - #saddles + #maxima is the Euler characteristic of the closed surface;
/// (2) a saddle has four arcs, alternately descending and ascending; (3) an arc joins a saddle and
/// an extremum and occurs once in the list of each; (4) the cells are the faces of that rotation
/// system, each with four sides (which may be the two sides of one arc), twice as many as saddles.
struct MorseSmaleComplex {
  std::vector<MorseNode> nodes;  ///< maxima, saddles, minima, each by falling value
  std::vector<MorseArc> arcs;
  std::vector<MorseCell> cells;

  [[nodiscard]] int count(NodeKind kind) const;
};

/// Reads the complex off `gradient`; `hierarchy` (of the gradient before simplification or any
/// later state of it) gives the persistence of the nodes.
MorseSmaleComplex morse_smale_complex(const DiscreteGradient& gradient,
                                      const PersistenceHierarchy& hierarchy);

struct MorseSmaleOptions {
  /// Pairs below it are cancelled, as a fraction of the range of the function on `scale`. 0.02 on
  /// the log scale is the canonical level: one count of tips for all cats, dogs and horses, and for
  /// all of FAUST. The paper prunes at 0.002 on the linear scale.
  double threshold = 0.02;
  FieldScale scale = FieldScale::kLog;
};

/// Gradient, hierarchy, simplification and complex of `values` (#V) in one call. Errors of
/// discrete_gradient and persistence_hierarchy.
Result<MorseSmaleComplex> morse_smale_complex(const TriangleMesh& mesh,
                                              const Eigen::VectorXd& values,
                                              const MorseSmaleOptions& options = {});

/// Checks the invariants of MorseSmaleComplex against the Euler characteristic of the closed
/// surface.
Status validate(const MorseSmaleComplex& complex, int euler);

}  // namespace crosspatch
