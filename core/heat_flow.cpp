#include "core/heat_flow.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>

namespace crosspatch {

Result<Eigen::MatrixXd> heat_flow_series(const TriangleMesh& mesh,
                                         const Eigen::VectorXd& values,
                                         double step,
                                         int levels) {
  const auto laplacian = compute_laplacian(mesh);
  if (!laplacian) return tl::unexpected(laplacian.error());
  const Eigen::VectorXd mass = laplacian->mass / laplacian->mass.sum();
  SparseMatrix A = step * laplacian->L;
  A.diagonal() += mass;
  const Eigen::SimplicialLDLT<SparseMatrix> solver(A);
  if (solver.info() != Eigen::Success)
    return fail(ErrorCode::kNumerical,
                fmt::format("heat flow: factorization of {} unknowns failed", A.rows()));
  Eigen::MatrixXd series(values.size(), levels);
  series.col(0) = values;
  for (int k = 1; k < levels; ++k)
    series.col(k) = solver.solve(mass.cwiseProduct(series.col(k - 1)));
  return series;
}

}  // namespace crosspatch
