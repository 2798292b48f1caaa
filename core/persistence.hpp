#pragma once

#include "core/discrete_gradient.hpp"

namespace crosspatch {

enum class NodeKind : std::uint8_t { kMinimum, kSaddle, kMaximum };

enum class FieldScale : std::uint8_t {
  kLinear,  ///< persistence is a difference of values, as in the paper
  kLog,     ///< a difference of logarithms: far steadier over shapes; values must be positive
};

/// One saddle taken away together with the extremum that it joins to a more extreme one.
struct Cancellation {
  int saddle;          ///< half-edge, an entry of DiscreteGradient::saddles
  NodeKind kind;       ///< of the extremum
  int extremum;        ///< vertex or face, an entry of minima or maxima
  double persistence;  ///< |difference of values| / range of values, both on `scale`
};

/// Every cancellation of a gradient, cheapest first.
///
/// Invariants: (1) persistence does not fall along `order`; (2) no saddle and no extremum occurs
/// twice; (3) after all of them one minimum and one maximum of each component are left, with twice
/// the genus saddles.
struct PersistenceHierarchy {
  FieldScale scale = FieldScale::kLinear;
  double range = 0;  ///< largest minus smallest value, on `scale`
  std::vector<Cancellation> order;
};

/// Orders the cancellations of `gradient`: always the cheapest (saddle, extremum) whose two paths
/// of that kind end differently. kBadInput for kLog with a value that is not positive. Cost:
/// S log S for S saddles. Source: Edelsbrunner, Harer & Zomorodian 2003; V-path cancellation of
/// Forman 1998.
Result<PersistenceHierarchy> persistence_hierarchy(const DiscreteGradient& gradient,
                                                   FieldScale scale);

/// The gradient after all cancellations below `threshold`.
DiscreteGradient simplify(DiscreteGradient gradient,
                          const PersistenceHierarchy& hierarchy,
                          double threshold);

}  // namespace crosspatch
