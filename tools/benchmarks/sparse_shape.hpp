#pragma once

#include <string>

#include "core/spectral_matching.hpp"
#include "tools/benchmarks/truth.hpp"

namespace crosspatch {

/// A surface with what the paper's matcher looks at.
struct SparseShape {
  std::string label;
  PreparedMesh prepared;
  ShapeFeatures features;
  MatchingShape matching;

  [[nodiscard]] const TriangleMesh& mesh() const { return prepared.mesh; }
};

/// Reads a mesh file, in its own numbering. Errors of reading and of the stages.
Result<SparseShape> read_sparse_shape(const std::string& path);

/// The shape of a mesh that has no file.
Result<SparseShape> make_sparse_shape(const std::string& label, TriangleMesh mesh);

/// A matching with the distance of each match from the truth; none where no truth is known.
struct JudgedMatching {
  Matching matching;
  std::vector<double> errors;

  /// Shares of the matches within 0.1 and 0.25 sqrt(area) of the truth; NaN without a truth.
  [[nodiscard]] double share_within(double distance) const;
};

/// Matches and judges. Where nothing can be matched the matching is empty.
JudgedMatching match_sparsely(const SparseShape& source,
                              const SparseShape& target,
                              const Truth& truth,
                              const SpectralMatchingOptions& options);

/// Vertex i of the one belongs to vertex i of the other.
Truth identity_truth(int vertices);

}  // namespace crosspatch
