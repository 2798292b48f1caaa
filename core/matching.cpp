#include "core/matching.hpp"

#include <fmt/format.h>

#include <set>
#include <tuple>

namespace crosspatch {

std::string_view name(NodeKind kind) {
  switch (kind) {
    case NodeKind::kMinimum:
      return "min";
    case NodeKind::kSaddle:
      return "saddle";
    case NodeKind::kMaximum:
      break;
  }
  return "max";
}

Status validate(const Matching& matching, int source_vertices, int target_vertices) {
  std::set<std::pair<NodeKind, int>> sources, targets;
  std::tuple<double, int> last{-2, -1};
  for (const Match& m : matching.matches) {
    if (m.source_vertex < 0 || m.source_vertex >= source_vertices || m.target_vertex < 0 ||
        m.target_vertex >= target_vertices)
      return fail(
          ErrorCode::kInternal,
          fmt::format("match {} -> {}: vertex out of range", m.source_vertex, m.target_vertex));
    if (!sources.insert({m.kind, m.source_vertex}).second ||
        !targets.insert({m.kind, m.target_vertex}).second)
      return fail(ErrorCode::kInternal,
                  fmt::format("match {} -> {}: matched twice", m.source_vertex, m.target_vertex));
    const std::tuple<double, int> key{-m.confidence, m.source_vertex};
    if (!(m.confidence >= 0 && m.confidence <= 1) || key < last)
      return fail(ErrorCode::kInternal,
                  fmt::format("match {} -> {}: confidence {} is out of range or order",
                              m.source_vertex,
                              m.target_vertex,
                              m.confidence));
    last = key;
  }
  return {};
}

}  // namespace crosspatch
