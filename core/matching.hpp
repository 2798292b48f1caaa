#pragma once

#include <string_view>
#include <vector>

#include "core/persistence.hpp"

namespace crosspatch {

/// Two critical points said to correspond.
struct Match {
  NodeKind kind = NodeKind::kMaximum;
  int source_vertex = -1;
  int target_vertex = -1;
  double confidence = 0;  ///< in [0, 1]; what it measures is the matcher's
};

/// A sparse correspondence. Invariants: (1) no vertex of a surface is matched twice with one kind;
/// (2) matches are sorted by falling confidence, ties by source vertex.
struct Matching {
  std::vector<Match> matches;
};

/// "max", "saddle" or "min".
std::string_view name(NodeKind kind);

/// Checks the invariants of Matching, and that vertices lie in [0, source) and [0, target).
Status validate(const Matching& matching, int source_vertices, int target_vertices);

}  // namespace crosspatch
