#include "param/node_matching.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/assignment.hpp"
#include "core/geodesics.hpp"
#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Vertices of the nodes of one kind, each once: a vertex may stand for several saddles.
std::vector<int> vertices_of(const MorseSmaleComplex& complex, NodeKind kind) {
  std::vector<int> vertices;
  for (const MorseNode& node : complex.nodes)
    if (node.kind == kind) vertices.push_back(node.vertex);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

/// Distances from the images of `from` (vertices of the map's source) to `to` (vertices of
/// `target`), over sqrt(area): from x to; infinite without an image.
Eigen::MatrixXd image_distances(const std::vector<int>& from,
                                const std::vector<int>& to,
                                const std::vector<int>& point_of_vertex,
                                const std::vector<SurfacePoint>& place,
                                const TriangleMesh& target) {
  const Eigen::MatrixXd distance = geodesic_distances(target, to) / std::sqrt(total_area(target));
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(from.size()),
                                                     static_cast<Eigen::Index>(to.size()),
                                                     std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < from.size(); ++i) {
    const int point = point_of_vertex[idx(from[i])];
    if (point < 0) continue;
    const SurfacePoint& p = place[idx(point)];
    auto row = result.row(static_cast<Eigen::Index>(i));
    row.setZero();
    for (int k = 0; k < 3; ++k) row += p.bary[k] * distance.row(target.F(p.face, k));
  }
  return result;
}

}  // namespace

Matching match_nodes(const TriangleMesh& source,
                     const TriangleMesh& target,
                     const MorseSmaleComplex& source_complex,
                     const MorseSmaleComplex& target_complex,
                     const SurfaceMap& map,
                     const NodeMatchingOptions& options) {
  Matching matching;
  for (const NodeKind kind : {NodeKind::kMaximum, NodeKind::kSaddle, NodeKind::kMinimum}) {
    const std::vector<int> a = vertices_of(source_complex, kind);
    const std::vector<int> b = vertices_of(target_complex, kind);
    if (a.empty() || b.empty()) continue;
    const Eigen::MatrixXd distance =
        (image_distances(a, b, map.point_of_source_vertex, map.target, target) +
         image_distances(b, a, map.point_of_target_vertex, map.source, source).transpose()) /
        2;
    // What is out of reach costs as much as staying alone, so that it pushes no other pair apart.
    const std::vector<int> partner = least_cost_assignment(distance.cwiseMin(options.reach));
    for (size_t i = 0; i < a.size(); ++i) {
      if (partner[i] < 0) continue;
      const double d = distance(static_cast<Eigen::Index>(i), partner[i]);
      if (d < options.reach)
        matching.matches.push_back({kind, a[i], b[idx(partner[i])], 1 - d / options.reach});
    }
  }
  std::sort(matching.matches.begin(), matching.matches.end(), [](const Match& x, const Match& y) {
    return std::tuple(-x.confidence, x.source_vertex, x.kind) <
           std::tuple(-y.confidence, y.source_vertex, y.kind);
  });
  return matching;
}

}  // namespace crosspatch
