#include "tools/benchmarks/truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geodesics.hpp"
#include "core/index.hpp"
#include "tools/input.hpp"
#include "tools/text_lines.hpp"

namespace crosspatch {
namespace {

Result<std::pair<int, int>> parse_pair(const TextLine& line,
                                       const PreparedMesh& source,
                                       const PreparedMesh& target) {
  const auto mesh_vertex = [](const PreparedMesh& mesh, int v) {
    const std::vector<int>& numbers = mesh.numbering.mesh_vertex;
    return v >= 0 && v < static_cast<int>(numbers.size()) ? numbers[idx(v)] : -1;
  };
  int s = -1, t = -1;
  if (line.words.size() < 2 || !parse_number(line.words[0], s) || !parse_number(line.words[1], t))
    return fail(ErrorCode::kBadInput, fmt::format("line {}: not two numbers", line.number));
  return std::pair{mesh_vertex(source, s), mesh_vertex(target, t)};
}

int true_vertex(const Truth& truth, const TriangleMesh& source, int vertex) {
  Eigen::Index best = 0;
  if (truth.dense) {
    const Eigen::VectorXd distance = geodesic_distance_to_set(source, {vertex});
    const auto nearest =
        std::min_element(truth.pairs.begin(), truth.pairs.end(), [&](const auto& a, const auto& b) {
          return distance[a.first] < distance[b.first];
        });
    return nearest->second;
  }
  constexpr double kReach = 0.35;
  const Eigen::RowVectorXd distance = truth.source_distances.row(vertex);
  const Eigen::VectorXd weight = (-distance.array() / kReach).exp().matrix().transpose();
  ((truth.target_distances.rowwise() - distance).cwiseAbs2() * weight).minCoeff(&best);
  return static_cast<int>(best);
}

}  // namespace

Result<Truth> read_truth(const std::string& path,
                         bool dense,
                         const PreparedMesh& source,
                         const PreparedMesh& target) {
  const Result<std::string> text = read_input_text(path);
  if (!text) return tl::unexpected(text.error());
  Truth truth;
  truth.dense = dense;
  for (const TextLine& line : text_lines(*text)) {
    const auto pair = parse_pair(line, source, target);
    if (!pair) return tl::unexpected(with_path(path, pair.error()));
    // What was left out of a mesh cannot be matched.
    if (pair->first >= 0 && pair->second >= 0) truth.pairs.push_back(*pair);
  }
  if (truth.pairs.empty()) return fail(ErrorCode::kBadInput, path + ": no pair of vertices");
  if (dense) return truth;
  std::vector<int> of_source, of_target;
  for (const auto& [s, t] : truth.pairs) {
    of_source.push_back(s);
    of_target.push_back(t);
  }
  truth.source_distances =
      geodesic_distances(source.mesh, of_source) / std::sqrt(total_area(source.mesh));
  truth.target_distances =
      geodesic_distances(target.mesh, of_target) / std::sqrt(total_area(target.mesh));
  return truth;
}

std::vector<double> match_errors(const Matching& matching,
                                 const Truth& truth,
                                 const TriangleMesh& source,
                                 const TriangleMesh& target) {
  std::vector<double> errors;
  for (const Match& match : matching.matches) {
    const int place = true_vertex(truth, source, match.source_vertex);
    errors.push_back(geodesic_distance_to_set(target, {place})[match.target_vertex] /
                     std::sqrt(total_area(target)));
  }
  return errors;
}

}  // namespace crosspatch
