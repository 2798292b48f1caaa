#include "core/spectral_matching.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "core/assignment.hpp"
#include "core/geodesics.hpp"
#include "core/index.hpp"
#include "core/order_correction.hpp"

namespace crosspatch {
namespace {

Eigen::MatrixXd diffusion_distances(const Spectrum& spectrum,
                                    const std::vector<int>& vertices,
                                    double time) {
  // d^2 = sum_i exp(-2 t lambda_i / lambda_1) (phi_i(x) - phi_i(y))^2, Coifman & Lafon 2006.
  const Eigen::ArrayXd decay = (-time / spectrum.values[1] * spectrum.values.array()).exp();
  const Eigen::MatrixXd points =
      spectrum.functions(vertices, Eigen::all) * decay.matrix().asDiagonal();
  Eigen::MatrixXd D(points.rows(), points.rows());
  for (Eigen::Index i = 0; i < D.rows(); ++i)
    for (Eigen::Index j = 0; j < D.rows(); ++j) D(i, j) = (points.row(i) - points.row(j)).norm();
  return D;
}

/// H(a, b) by Eq. (4).
double distance_score(double d1, double d2, double sigma) {
  if (!(d1 + d2 > 0)) return 1;
  const double ratio = (d1 - d2) / (d1 + d2);
  return std::exp(-ratio * ratio / (sigma * sigma));
}

double pair_score(const MatchingShape& source,
                  const MatchingShape& target,
                  const NodePair& a,
                  const NodePair& b,
                  const SpectralMatchingOptions& options) {
  // Assignments that share a node exclude each other.
  if (a.source == b.source || a.target == b.target) return 0;
  switch (options.constraint) {
    case PairConstraint::kGeodesic:
      return distance_score(
          source.geodesic(a.source, b.source), target.geodesic(a.target, b.target), options.sigma);
    case PairConstraint::kDiffusion:
      return distance_score(source.diffusion(a.source, b.source),
                            target.diffusion(a.target, b.target),
                            options.sigma);
    case PairConstraint::kConnectivity:
      break;
  }
  return source.adjacency(a.source, b.source) * target.adjacency(a.target, b.target);
}

/// Fills `partner` from the highest score down, skipping nodes already taken.
std::vector<int> select_greedily(const std::vector<NodePair>& possible,
                                 const Eigen::VectorXd& x,
                                 int source_nodes,
                                 int target_nodes) {
  std::vector<size_t> order(possible.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return x[static_cast<Eigen::Index>(a)] > x[static_cast<Eigen::Index>(b)];
  });
  std::vector<int> partner(idx(source_nodes), -1);
  std::vector<bool> taken(idx(target_nodes), false);
  constexpr double kZero = 1e-9;  // of the largest entry: not reached by the power iteration
  for (const size_t i : order) {
    const NodePair& a = possible[i];
    if (x[static_cast<Eigen::Index>(i)] < kZero) break;
    if (partner[idx(a.source)] >= 0 || taken[idx(a.target)]) continue;
    partner[idx(a.source)] = a.target;
    taken[idx(a.target)] = true;
  }
  return partner;
}

/// Partners and the score of each pair (source nodes x target nodes).
struct Selection {
  std::vector<int> partner;
  Eigen::MatrixXd score;
};

Selection match_spectrally(const MatchingShape& source,
                           const MatchingShape& target,
                           const Eigen::MatrixXd& H,
                           const SpectralMatchingOptions& options) {
  std::vector<NodePair> possible;
  for (int i = 0; i < H.rows(); ++i)
    for (int j = 0; j < H.cols(); ++j)
      if (H(i, j) > 0 && H(i, j) >= options.epsilon) possible.push_back({i, j, H(i, j)});
  Selection result{std::vector<int>(idx(H.rows()), -1), Eigen::MatrixXd::Zero(H.rows(), H.cols())};
  if (possible.empty()) return result;
  const Eigen::VectorXd x = principal_eigenvector(score_matrix(source, target, possible, options));
  for (size_t i = 0; i < possible.size(); ++i)
    result.score(possible[i].source, possible[i].target) = x[static_cast<Eigen::Index>(i)];
  result.partner =
      select_greedily(possible, x, static_cast<int>(H.rows()), static_cast<int>(H.cols()));
  if (options.order_correction)
    correct_order(source.graph, target.graph, result.score, result.partner);
  return result;
}

Selection match_directly(const Eigen::MatrixXd& H) {
  Selection result{least_cost_assignment(-H), H};
  for (int i = 0; i < H.rows(); ++i)
    if (result.partner[idx(i)] >= 0 && !(H(i, result.partner[idx(i)]) > 0))
      result.partner[idx(i)] = -1;  // of different kinds
  return result;
}

/// Value of a node in the range of ADF over all nodes of its surface.
double relative_value(const MatchingShape& shape, int node) {
  const double low = shape.auto_diffusion.minCoeff(), high = shape.auto_diffusion.maxCoeff();
  return high > low ? (shape.auto_diffusion(node, 0) - low) / (high - low) : 1;
}

/// A vertex may stand for several saddles (a monkey saddle): its most confident match stays.
void drop_repeated_vertices(Matching& matching) {
  std::set<std::pair<NodeKind, int>> sources, targets;
  std::erase_if(matching.matches, [&](const Match& m) {
    if (sources.contains({m.kind, m.source_vertex}) || targets.contains({m.kind, m.target_vertex}))
      return true;
    sources.insert({m.kind, m.source_vertex});
    targets.insert({m.kind, m.target_vertex});
    return false;
  });
}

}  // namespace

Result<MatchingShape> matching_shape(const TriangleMesh& mesh,
                                     const ShapeFeatures& features,
                                     const FeatureGraphOptions& options,
                                     double diffusion_time) {
  const Eigen::VectorXd adf = features.log_adf.array().exp();
  auto graph = build_feature_graph(mesh, adf, features.spectrum.values[1], options);
  if (!graph) return tl::unexpected(graph.error());
  std::vector<int> vertices;
  for (const MorseNode& node : graph->complex.nodes) vertices.push_back(node.vertex);
  MatchingShape shape;
  shape.auto_diffusion = adf(vertices);
  shape.heat_kernel = features.log_hks(vertices, Eigen::all).array().exp();
  shape.adjacency = adjacency(*graph);
  shape.geodesic =
      geodesic_distances(mesh, vertices)(vertices, Eigen::all) / std::sqrt(total_area(mesh));
  shape.geodesic = (0.5 * (shape.geodesic + shape.geodesic.transpose())).eval();
  shape.diffusion = diffusion_distances(features.spectrum, vertices, diffusion_time);
  shape.graph = std::move(*graph);
  return shape;
}

Eigen::MatrixXd node_scores(const MatchingShape& source,
                            const MatchingShape& target,
                            NodeSignature signature) {
  const bool adf = signature == NodeSignature::kAutoDiffusion;
  const Eigen::MatrixXd& f1 = adf ? source.auto_diffusion : source.heat_kernel;
  const Eigen::MatrixXd& f2 = adf ? target.auto_diffusion : target.heat_kernel;
  Eigen::MatrixXd difference(f1.rows(), f2.rows());
  for (Eigen::Index i = 0; i < f1.rows(); ++i)
    for (Eigen::Index j = 0; j < f2.rows(); ++j) difference(i, j) = (f1.row(i) - f2.row(j)).norm();
  const double R = difference.size() > 0 ? difference.maxCoeff() : 0;
  Eigen::MatrixXd H(f1.rows(), f2.rows());
  for (int i = 0; i < f1.rows(); ++i)
    for (int j = 0; j < f2.rows(); ++j) {
      const bool same = source.graph.node(i).kind == target.graph.node(j).kind;
      H(i, j) = same ? 1 - std::sqrt(R > 0 ? difference(i, j) / R : 0) : 0;
    }
  return H;
}

Eigen::MatrixXd score_matrix(const MatchingShape& source,
                             const MatchingShape& target,
                             const std::vector<NodePair>& assignments,
                             const SpectralMatchingOptions& options) {
  const auto n = static_cast<Eigen::Index>(assignments.size());
  Eigen::MatrixXd M(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    M(i, i) = options.alpha * assignments[idx(i)].score;
    for (Eigen::Index j = 0; j < i; ++j)
      M(i, j) = M(j, i) =
          (1 - options.alpha) *
          pair_score(source, target, assignments[idx(i)], assignments[idx(j)], options);
  }
  return M;
}

Eigen::VectorXd principal_eigenvector(const Eigen::MatrixXd& M) {
  // Shifted, so that an eigenvalue -lambda_max (bipartite graphs) cannot keep up.
  const double shift = 0.25 * M.rowwise().sum().maxCoeff();
  Eigen::VectorXd x = Eigen::VectorXd::Ones(M.rows());
  constexpr int kIterations = 5000;
  constexpr double kSettled = 1e-12;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::VectorXd y = M * x + shift * x;
    const double largest = y.maxCoeff();
    if (!(largest > 0)) return x;
    y /= largest;
    const double change = (y - x).cwiseAbs().maxCoeff();
    x = std::move(y);
    if (change < kSettled) break;
  }
  return x;
}

Result<Matching> spectral_matching(const MatchingShape& source,
                                   const MatchingShape& target,
                                   const SpectralMatchingOptions& options) {
  const Eigen::MatrixXd H = node_scores(source, target, options.signature);
  const Selection selection = options.method == MatchMethod::kHungarian
                                  ? match_directly(H)
                                  : match_spectrally(source, target, H, options);
  Matching matching;
  for (int i = 0; i < H.rows(); ++i) {
    const int j = selection.partner[idx(i)];
    if (j < 0) continue;
    if (relative_value(source, i) < options.least_value &&
        relative_value(target, j) < options.least_value)
      continue;
    matching.matches.push_back({source.graph.node(i).kind,
                                source.graph.node(i).vertex,
                                target.graph.node(j).vertex,
                                selection.score(i, j)});
  }
  if (matching.matches.empty())
    return fail(ErrorCode::kNoCorrespondence,
                fmt::format("matching: none of {} x {} node pairs is left above H = {}",
                            H.rows(),
                            H.cols(),
                            options.epsilon));
  std::sort(matching.matches.begin(), matching.matches.end(), [](const Match& a, const Match& b) {
    return std::tuple(-a.confidence, a.source_vertex, a.kind) <
           std::tuple(-b.confidence, b.source_vertex, b.kind);
  });
  drop_repeated_vertices(matching);
  return matching;
}

}  // namespace crosspatch
