#include <fmt/format.h>

#include <cmath>

#include "core/geodesics.hpp"
#include "tools/benchmarks/paper.hpp"

namespace crosspatch {
namespace {

constexpr double kNear = 0.1, kFar = 0.25;  // of the square root of the area

std::string share(const JudgedMatching& judged, double distance) {
  const double value = judged.share_within(distance);
  return std::isnan(value) ? "" : fmt::format("{:.3f}", value);
}

}  // namespace

std::string columns(const JudgedMatching& judged) {
  return fmt::format(
      "{},{},{}", judged.matching.matches.size(), share(judged, kNear), share(judged, kFar));
}

int same_node(const SparseShape& null, const SparseShape& shape, int i) {
  const MorseNode& node = null.matching.graph.node(i);
  const Eigen::VectorXd distance = geodesic_distance_to_set(shape.mesh(), {node.vertex});
  int nearest = -1;
  double least = kNear * std::sqrt(total_area(shape.mesh()));
  for (int j = 0; j < shape.matching.graph.node_count(); ++j) {
    const MorseNode& other = shape.matching.graph.node(j);
    if (other.kind != node.kind || distance[other.vertex] > least) continue;
    least = distance[other.vertex];
    nearest = j;
  }
  return nearest;
}

Status finish_sheet(const PaperArguments& arguments, const PictureSheet& sheet, int columns_wide) {
  if (arguments.output.empty()) return {};
  return write_sheet(
      sheet, columns_wide, fmt::format("{}/figure_{}.png", arguments.output, arguments.figure));
}

}  // namespace crosspatch
