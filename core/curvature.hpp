#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

struct CurvatureOptions {
  /// Diffusion times of the smoothing, in units of the surface's area: details of about their
  /// square roots survive.
  std::vector<double> times = {2e-4, 1e-3};
};

/// What the surface looks like around each vertex, comparable between surfaces of any size: #V x 2
/// times. For each time the mean curvature (positive where convex) and the Gaussian curvature,
/// smoothed, compressed by asinh in units of their mean magnitude, and scaled to unit variance
/// (area-weighted; a field that varies by less than a twentieth of itself becomes 0).
///
/// Source: mean curvature normal from the cotangent Laplacian and angle defects (Meyer, Desbrun,
/// Schroeder & Barr 2003). Errors of compute_laplacian; kNumerical where a factorization fails.
Result<Eigen::MatrixXd> curvature_fields(const TriangleMesh& mesh,
                                         const CurvatureOptions& options = {});

/// Mean curvature integrated around each vertex (#V), twice, positive where convex. Errors of
/// compute_laplacian.
Result<Eigen::VectorXd> integrated_mean_curvature(const TriangleMesh& mesh);

}  // namespace crosspatch
