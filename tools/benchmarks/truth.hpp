#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/matching.hpp"
#include "core/prepare.hpp"
#include "tools/benchmarks/data_set.hpp"

namespace crosspatch {

/// Which vertex of the target a vertex of the source truly belongs to.
///
/// Where the truth is dense, it is read at the nearest source vertex (geodesically) that it names.
/// Where it is a few landmarks, it is the target vertex whose distances to them are most like those
/// on the source, each weighted by exp(-distance / 0.35), in sqrt(area): near a landmark that
/// landmark decides, elsewhere all around do.
struct Truth {
  std::vector<std::pair<int, int>> pairs;  ///< mesh vertices
  bool dense = false;
  Eigen::MatrixXd source_distances;  ///< #V x pairs, over sqrt(area); empty where dense
  Eigen::MatrixXd target_distances;
};

/// Reads the file of a truth (two columns of file vertices). kBadInput for one that names no
/// vertices of the meshes.
Result<Truth> read_truth(const std::string& path,
                         bool dense,
                         const PreparedMesh& source,
                         const PreparedMesh& target);

/// Geodesic distance on the target from each match's target vertex to the true place of its source
/// vertex, over sqrt(area).
std::vector<double> match_errors(const Matching& matching,
                                 const Truth& truth,
                                 const TriangleMesh& source,
                                 const TriangleMesh& target);

}  // namespace crosspatch
