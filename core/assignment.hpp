#pragma once

#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// The one-to-one assignment of rows to columns of least total cost: result[i] is the column of row
/// i, or -1 for the rows left over when there are more rows than columns. Source: Kuhn 1955, by
/// shortest augmenting paths (Jonker & Volgenant 1987). Cost: rows^2 * columns.
std::vector<int> least_cost_assignment(const Eigen::MatrixXd& cost);

}  // namespace crosspatch
