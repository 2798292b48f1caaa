#include "core/chirality.hpp"

#include <array>
#include <cmath>

#include "core/curvature.hpp"
#include "core/signatures.hpp"

namespace crosspatch {
namespace {

/// Heat flow for one over eigenvalue `k` of the function with the integrals `integrated` around
/// each vertex.
Eigen::VectorXd smoothed(const Spectrum& spectrum, const Eigen::VectorXd& integrated, int k) {
  const double time = 1 / spectrum.values[std::min(k, spectrum.count() - 1)];
  const Eigen::VectorXd coefficients = spectrum.functions.transpose() * integrated;
  return spectrum.functions *
         ((-time * spectrum.values.array()).exp() * coefficients.array()).matrix();
}

/// Integrals of n . (grad f x grad g) around each vertex. On a triangle it is the doubled area of
/// the image of the triangle under (f, g), over that of the triangle itself.
Eigen::VectorXd pseudo_scalar(const TriangleMesh& mesh,
                              const Eigen::VectorXd& f,
                              const Eigen::VectorXd& g) {
  Eigen::VectorXd integral = Eigen::VectorXd::Zero(mesh.vertex_count());
  for (int t = 0; t < mesh.face_count(); ++t) {
    const int a = mesh.F(t, 0), b = mesh.F(t, 1), c = mesh.F(t, 2);
    const double doubled = (f[b] - f[a]) * (g[c] - g[a]) - (f[c] - f[a]) * (g[b] - g[a]);
    for (const int v : {a, b, c}) integral[v] += doubled / 6;
  }
  return integral;
}

}  // namespace

Result<Eigen::MatrixXd> chirality_fields(const TriangleMesh& mesh, const Spectrum& spectrum) {
  constexpr int kCoarse = 9, kFine = 39;  // eigenvalues that smoothing is matched to
  const auto curvature = integrated_mean_curvature(mesh);
  if (!curvature) return tl::unexpected(curvature.error());
  const Eigen::VectorXd coarse = smoothed(spectrum, *curvature, kCoarse);
  const Eigen::VectorXd fine = smoothed(spectrum, *curvature, kFine);
  const Eigen::MatrixXd wks =
      wave_kernel_signature(spectrum, {.energies = 12, .variance = 1.5}).array().log();
  const auto low = wks.col(1), middle = wks.col(4);
  const std::array<Eigen::VectorXd, 3> raw{pseudo_scalar(mesh, coarse, low),
                                           pseudo_scalar(mesh, coarse, middle),
                                           pseudo_scalar(mesh, fine, middle)};
  Eigen::MatrixXd fields = Eigen::MatrixXd::Zero(mesh.vertex_count(), 3);
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd field = smoothed(spectrum, raw[static_cast<std::size_t>(k)], kFine);
    const double square = spectrum.mass.dot(field.cwiseAbs2());
    if (square > 0) fields.col(k) = field / std::sqrt(square);
  }
  return fields;
}

}  // namespace crosspatch
