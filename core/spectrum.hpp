#pragma once

#include "core/laplacian.hpp"

namespace crosspatch {

struct SpectrumOptions {
  /// Eigenpairs wanted; a mesh of n vertices gives at most n. 100 suffice for the heat and wave
  /// kernel signatures.
  int count = 100;
  LaplacianOptions laplacian{};
  /// Residual bound of the eigensolver, relative to the largest Ritz value of the inverse.
  double tolerance = 1e-9;
  /// Vertices above which CHOLMOD's supernodal factor is used: below it Eigen's simplicial one was
  /// as fast.
  int supernodal_from = 50000;
};

/// The lowest eigenpairs of L phi = lambda M phi of the surface scaled to total area 1, so that
/// nothing depends on units.
///
/// Invariants: (1) 0 = values[0] <= values[1] <= ...; (2) functions^T diag(mass) functions = I up
/// to rounding; (3) mass sums to 1; (4) the entry of largest magnitude of each function (the first
/// one of those within 1e-6 of it) is positive.
struct Spectrum {
  Eigen::VectorXd values;     ///< k, dimensionless (eigenvalue times area)
  Eigen::MatrixXd functions;  ///< #V x k
  Eigen::VectorXd mass;       ///< #V
  double residual;            ///< largest |L phi - lambda M phi| / (1 + lambda) in the M^-1 norm

  [[nodiscard]] int count() const { return static_cast<int>(values.size()); }
};

/// Computes `options.count` eigenpairs by shift-invert Lanczos. kBadInput from the Laplacian
/// or when the surface is not connected; kNumerical when the factorization or the eigensolver
/// fails.
Result<Spectrum> compute_spectrum(const TriangleMesh& mesh, const SpectrumOptions& options = {});

/// Checks the invariants of Spectrum.
Status validate(const Spectrum& spectrum);

}  // namespace crosspatch
