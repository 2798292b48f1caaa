#include "core/signatures.hpp"

#include <cassert>
#include <cmath>

namespace crosspatch {
namespace {

/// sum_i weights[i] phi_i^2 over the first weights.size() functions.
Eigen::VectorXd weighted_squares(const Spectrum& spectrum, const Eigen::VectorXd& weights) {
  return spectrum.functions.leftCols(weights.size()).array().square().matrix() * weights;
}

/// exp(-t lambda_i / lambda_1) of the first n pairs.
Eigen::VectorXd heat_weights(const Spectrum& spectrum, double time, Eigen::Index n) {
  return (-time / spectrum.values[1] * spectrum.values.head(n).array()).exp();
}

}  // namespace

Eigen::VectorXd auto_diffusion(const Spectrum& spectrum, const AutoDiffusionOptions& options) {
  assert(spectrum.count() >= 2);
  const Eigen::VectorXd weights = heat_weights(spectrum, options.time, spectrum.count());
  const auto kept = (weights.array() >= options.cutoff).count();  // weights fall with i
  return weighted_squares(spectrum, weights.head(kept));
}

Eigen::MatrixXd heat_kernel_signature(const Spectrum& spectrum, const HeatKernelOptions& options) {
  assert(spectrum.count() >= 2 && options.times >= 1);
  const auto n = std::min<Eigen::Index>(options.eigenpairs, spectrum.count());
  Eigen::MatrixXd weights(n, options.times);
  const double step =
      options.times > 1 ? std::log(options.last / options.first) / (options.times - 1) : 0;
  for (int j = 0; j < options.times; ++j)
    weights.col(j) = heat_weights(spectrum, options.first * std::exp(step * j), n);
  return spectrum.functions.leftCols(n).array().square().matrix() * weights;
}

Eigen::MatrixXd log_heat_kernel_signature(const Spectrum& spectrum,
                                          const HeatKernelOptions& options) {
  return heat_kernel_signature(spectrum, options).array().log();
}

Eigen::MatrixXd wave_kernel_signature(const Spectrum& spectrum, const WaveKernelOptions& options) {
  assert(spectrum.count() >= 3 && options.energies >= 2);
  const Eigen::Index n = spectrum.count() - 1;  // the constant function has no energy
  const Eigen::ArrayXd log_values = spectrum.values.tail(n).array().log();
  // The authors' program ends the range at log lambda_max / 1.02, so that the outermost Gaussians
  // stay inside the computed spectrum.
  const double first = log_values[0], last = log_values[n - 1] / 1.02;
  const double sigma = options.variance * (last - first) / options.energies;
  Eigen::MatrixXd weights(n, options.energies);
  for (int j = 0; j < options.energies; ++j) {
    const double energy = first + (last - first) * j / (options.energies - 1);
    const Eigen::ArrayXd w = (-(energy - log_values).square() / (2 * sigma * sigma)).exp();
    weights.col(j) = w / w.sum();
  }
  return spectrum.functions.rightCols(n).array().square().matrix() * weights;
}

}  // namespace crosspatch
