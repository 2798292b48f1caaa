#pragma once

#include "core/spectrum.hpp"

namespace crosspatch {

struct AutoDiffusionOptions {
  double time = 0.5;     ///< t of Eq. (1), in units of 1 / lambda_1 (paper, Sec. 4.1)
  double cutoff = 0.01;  ///< terms with exp(-t lambda_i / lambda_1) below it are left out
};

/// Auto diffusion function (#V), positive: sum_i exp(-t lambda_i / lambda_1) phi_i^2. On the
/// surface of area 1. Source: Feng et al. 2013, Eq. (1).
Eigen::VectorXd auto_diffusion(const Spectrum& spectrum, const AutoDiffusionOptions& options = {});

struct HeatKernelOptions {
  int times = 10;      ///< samples, uniform in log t (paper, Sec. 6)
  double first = 0.1;  ///< in units of 1 / lambda_1
  double last = 4;
  int eigenpairs = 50;  ///< at most (paper, Sec. 6)
};

/// Heat kernel signature (#V x times): column j is sum_i exp(-t_j lambda_i / lambda_1) phi_i^2.
/// Positive. Source: Sun, Ovsjanikov & Guibas 2009.
Eigen::MatrixXd heat_kernel_signature(const Spectrum& spectrum,
                                      const HeatKernelOptions& options = {});

/// Natural logarithm of the heat kernel signature (#V x times).
Eigen::MatrixXd log_heat_kernel_signature(const Spectrum& spectrum,
                                          const HeatKernelOptions& options = {});

struct WaveKernelOptions {
  int energies = 100;   ///< samples of log energy (Aubry et al. 2011)
  double variance = 7;  ///< standard deviation, in steps between energies (same source)
};

/// Wave kernel signature (#V x energies). Each column is a weighted mean of the phi_i^2, weights
/// adding to 1. Source: Aubry, Schlickewei & Cremers 2011.
Eigen::MatrixXd wave_kernel_signature(const Spectrum& spectrum,
                                      const WaveKernelOptions& options = {});

}  // namespace crosspatch
