#pragma once

#include "core/laplacian.hpp"

namespace crosspatch {

/// `values` (#V) and what heat flow makes of them after 1, 2, ... steps of time `step` on the
/// surface scaled to area 1: a #V x levels matrix, one implicit Euler step from column to column.
/// The mean (by mass) is kept and no new extremum appears. Errors of compute_laplacian; kNumerical
/// if the factorization fails.
Result<Eigen::MatrixXd> heat_flow_series(const TriangleMesh& mesh,
                                         const Eigen::VectorXd& values,
                                         double step,
                                         int levels);

}  // namespace crosspatch
