#include "core/signatures.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace crosspatch {
namespace {

TEST(Signatures, AreConstantOnTheSphere) {
  const Spectrum spectrum = compute_spectrum(shapes::icosphere(3), {.count = 81}).value();
  const auto spread = [](const Eigen::VectorXd& f) { return f.maxCoeff() / f.minCoeff() - 1; };
  // The icosphere's vertices are of two kinds; its symmetry is broken by the mesh only.
  EXPECT_LT(spread(auto_diffusion(spectrum)), 0.02);
  EXPECT_LT(spread(heat_kernel_signature(spectrum).col(9)), 0.02);
}

TEST(Signatures, HeatTraceIsTheMeanOfTheSignature) {
  const Spectrum spectrum = compute_spectrum(shapes::torus(3, 1, 40, 16), {.count = 50}).value();
  const Eigen::MatrixXd hks =
      heat_kernel_signature(spectrum, {.times = 3, .first = 0.5, .last = 2});
  for (int j = 0; j < 3; ++j) {
    const double t = std::pow(2.0, j - 1);
    const double trace = (-t * spectrum.values.array() / spectrum.values[1]).exp().sum();
    EXPECT_NEAR(spectrum.mass.dot(hks.col(j)), trace, 1e-9 * trace);  // orthonormality
  }
}

TEST(Signatures, AutoDiffusionIsTheTruncatedHeatKernelAtItsTime) {
  const Spectrum spectrum = compute_spectrum(shapes::torus(3, 1, 40, 16), {.count = 50}).value();
  const Eigen::VectorXd adf = auto_diffusion(spectrum, {.time = 0.5, .cutoff = 0});
  const Eigen::MatrixXd hks =
      heat_kernel_signature(spectrum, {.times = 1, .first = 0.5, .last = 0.5});
  EXPECT_LT((adf - hks.col(0)).norm(), 1e-12 * adf.norm());  // rounding
  // The terms dropped by the cutoff are each below 0.01 phi^2.
  EXPECT_TRUE((auto_diffusion(spectrum).array() <= adf.array()).all());
  EXPECT_GE(auto_diffusion(spectrum).minCoeff(), 1 - 1e-9);  // the constant function alone gives 1
}

TEST(Signatures, IgnoreScaleAndVertexNumbers) {
  TriangleMesh mesh = shapes::torus(3, 1, 30, 12);
  for (int v = 0; v < mesh.vertex_count(); ++v) mesh.V.row(v) *= 1 + 0.1 * mesh.V(v, 0);
  const int n = mesh.vertex_count();
  MatrixX3d V(n, 3);
  for (int v = 0; v < n; ++v) V.row(n - 1 - v) = 5 * mesh.V.row(v);
  const TriangleMesh turned = make_mesh(V, (n - 1 - mesh.F.array()).matrix()).value();
  const Spectrum a = compute_spectrum(mesh).value(), b = compute_spectrum(turned).value();
  EXPECT_LT((auto_diffusion(a) - auto_diffusion(b).reverse()).norm(),
            1e-6 * auto_diffusion(a).norm());  // solver tolerance
  const Eigen::MatrixXd wks = wave_kernel_signature(a, {.energies = 20});
  EXPECT_LT((wks - wave_kernel_signature(b, {.energies = 20}).colwise().reverse()).norm(),
            1e-6 * wks.norm());
}

TEST(Signatures, WaveKernelHasMeanOne) {
  const Spectrum spectrum = compute_spectrum(shapes::torus(3, 1, 40, 16)).value();
  const Eigen::MatrixXd wks = wave_kernel_signature(spectrum);
  EXPECT_EQ(wks.cols(), 100);
  for (int j = 0; j < 100; ++j)
    EXPECT_NEAR(spectrum.mass.dot(wks.col(j)), 1, 1e-9);  // weights add to 1, functions have norm 1
}

}  // namespace
}  // namespace crosspatch
