#pragma once

#include "core/features.hpp"

namespace crosspatch {

/// A path between a saddle and an extremum, in the complex or only possible.
struct FeatureArc {
  int saddle = -1;
  int extremum = -1;
  double weight = 1;      ///< Eq. (2): (N - k) / N, k the first smoothed function with such a path
  std::vector<int> path;  ///< mesh vertices from the saddle to the extremum
};

/// The paper's feature graph (Sec. 4.2): the critical points of the auto diffusion function, the
/// arcs of its Morse-Smale complex and further ascending and descending paths.
///
/// Invariants: (1) arcs 0 .. complex.arcs.size() - 1 are those of `complex`, with weight 1; (2) the
/// others join a saddle and an extremum that no arc before them joins, with weight in (0, 1]; (3)
/// rotation[v] holds each arc at node v once, counter-clockwise, and those of the complex in the
/// complex's own cyclic order.
struct FeatureGraph {
  MorseSmaleComplex complex;  ///< nodes of the graph are its nodes
  std::vector<FeatureArc> arcs;
  std::vector<std::vector<int>> rotation;

  [[nodiscard]] int node_count() const { return static_cast<int>(complex.nodes.size()); }
  [[nodiscard]] const MorseNode& node(int i) const {
    return complex.nodes[static_cast<std::size_t>(i)];
  }
};

struct FeatureGraphOptions {
  /// Pruning: the paper's threshold, of the range of ADF; {0.02, kLog} is the canonical level.
  MorseSmaleOptions complex{.threshold = 0.002, .scale = FieldScale::kLinear};
  int levels = 10;  ///< N, functions in the series f_0 .. f_{N-1} (paper, Sec. 4.2)
  /// Time of heat flow from one function to the next, in units of 1 / lambda_1. The paper says 0.1
  /// of a Gaussian filter; read as heat flow, as only that gives weights below 1.
  double smoothing_step = 0.1;
};

/// Builds the feature graph of `adf` (#V, positive). A saddle is joined to each higher maximum that
/// a path of rising mesh edges reaches in some f_k, and to each lower minimum likewise. `lambda_1`
/// is the spectrum's. Errors of morse_smale_complex; kNumerical if the heat flow cannot be solved.
Result<FeatureGraph> build_feature_graph(const TriangleMesh& mesh,
                                         const Eigen::VectorXd& adf,
                                         double lambda_1,
                                         const FeatureGraphOptions& options = {});

/// Checks the invariants of FeatureGraph.
Status validate(const FeatureGraph& graph);

/// The largest weight of an arc between two nodes, if there is one: #nodes x #nodes, symmetric, 0
/// where there is none.
Eigen::MatrixXd adjacency(const FeatureGraph& graph);

}  // namespace crosspatch
