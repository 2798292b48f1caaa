#pragma once

#include "core/feature_graph.hpp"
#include "core/matching.hpp"

namespace crosspatch {

/// What H(a, b) compares (paper, Secs. 5.1 and 6).
enum class PairConstraint : std::uint8_t {
  kConnectivity,  ///< arcs of the feature graphs
  kGeodesic,      ///< Eq. (4) with geodesic distances
  kDiffusion,     ///< Eq. (4) with diffusion distances
};

/// What H(a) compares.
enum class NodeSignature : std::uint8_t { kAutoDiffusion, kHeatKernel };

enum class MatchMethod : std::uint8_t {
  kSpectral,   ///< Leordeanu & Hebert 2005 (paper, Sec. 5.2)
  kHungarian,  ///< H(a) alone, assigned at best total (paper, Sec. 6, alpha = 1)
};

/// A feature graph with all that the matchers look at; matrices have a row a node.
struct MatchingShape {
  FeatureGraph graph;
  Eigen::MatrixXd auto_diffusion;  ///< nodes x 1
  Eigen::MatrixXd heat_kernel;     ///< nodes x 10 (HeatKernelOptions)
  Eigen::MatrixXd adjacency;       ///< nodes x nodes: arc weights
  Eigen::MatrixXd geodesic;        ///< nodes x nodes, over sqrt(area)
  Eigen::MatrixXd diffusion;       ///< nodes x nodes, at the time of the auto diffusion function
};

/// Builds the graph of a surface and its matrices. Errors of build_feature_graph.
Result<MatchingShape> matching_shape(const TriangleMesh& mesh,
                                     const ShapeFeatures& features,
                                     const FeatureGraphOptions& options = {},
                                     double diffusion_time = 0.5);

struct SpectralMatchingOptions {
  MatchMethod method = MatchMethod::kSpectral;
  PairConstraint constraint = PairConstraint::kConnectivity;
  NodeSignature signature = NodeSignature::kAutoDiffusion;
  double alpha = 0.5;    ///< balance of Eq. (3); results hardly change in 0.02 .. 0.7
  double epsilon = 0.6;  ///< assignments with H(a) below it are dropped; 0.2 if far from isometric
  double sigma = 0.5;    ///< of Eq. (4)
  bool order_correction = true;  ///< Sec. 5.3
  /// Matches are removed whose values both lie below it, in the range of ADF over the nodes: points
  /// near the minimum drift (paper, Sec. 6, without a number; ours). 0 removes none.
  double least_value = 0.05;
};

/// Matches two surfaces the way of the paper. Confidence is the entry of the principal eigenvector
/// over its largest (kSpectral), or H(a) (kHungarian). kNoCorrespondence if nothing can be matched.
/// Source: Feng et al. 2013, Sec. 5.
Result<Matching> spectral_matching(const MatchingShape& source,
                                   const MatchingShape& target,
                                   const SpectralMatchingOptions& options = {});

/// H(a) of all node pairs (source nodes x target nodes), in [0, 1]; 0 where kinds differ.
Eigen::MatrixXd node_scores(const MatchingShape& source,
                            const MatchingShape& target,
                            NodeSignature signature);

/// A possible assignment of two nodes, with H(a).
struct NodePair {
  int source = -1;
  int target = -1;
  double score = 0;
};

/// The matrix M of the paper (Sec. 5.2) over the given assignments: alpha H(a) on the diagonal,
/// (1 - alpha) H(a, b) elsewhere, 0 where two assignments share a node.
Eigen::MatrixXd score_matrix(const MatchingShape& source,
                             const MatchingShape& target,
                             const std::vector<NodePair>& assignments,
                             const SpectralMatchingOptions& options = {});

/// The principal eigenvector of a symmetric non-negative matrix, by power iteration from the vector
/// of ones: non-negative, largest entry 1.
Eigen::VectorXd principal_eigenvector(const Eigen::MatrixXd& M);

}  // namespace crosspatch
