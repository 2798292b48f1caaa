#include "core/laplacian.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "shapes.hpp"

namespace crosspatch {
namespace {

/// A sphere with slivers: vertices pushed onto the neighbouring edge's middle.
TriangleMesh sliver_sphere() {
  TriangleMesh mesh = shapes::icosphere(2);
  for (int v = 0; v < mesh.vertex_count(); v += 9) {
    const int h = mesh.out[static_cast<size_t>(v)];
    mesh.V.row(v) = 0.5 * (mesh.V.row(mesh.to(h)) + mesh.V.row(mesh.tip(h)));
  }
  return mesh;
}

std::vector<TriangleMesh> all_shapes() {
  return {shapes::tetrahedron(),
          shapes::icosphere(2),
          shapes::grid(6),
          shapes::torus(2, 1, 40, 5),
          sliver_sphere()};
}

TEST(Laplacian, IsPositiveSemidefiniteWithOneDimensionalNullSpace) {
  for (const TriangleMesh& mesh : all_shapes()) {
    const Laplacian laplacian = compute_laplacian(mesh).value();
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(laplacian.L)).eigenvalues();
    const double rounding = 1e-12 * values.maxCoeff();
    EXPECT_NEAR(values[0], 0, rounding);
    EXPECT_GT(values[1], 100 * rounding);
    EXPECT_GT(laplacian.mass.minCoeff(), 0);
  }
}

TEST(Laplacian, ConstantsAreInItsNullSpace) {
  for (const TriangleMesh& mesh : all_shapes()) {
    const Laplacian laplacian = compute_laplacian(mesh).value();
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(mesh.vertex_count());
    const double rounding = 1e-13 * laplacian.L.coeffs().cwiseAbs().maxCoeff();
    EXPECT_LT((laplacian.L * ones).cwiseAbs().maxCoeff(), rounding);
  }
}

TEST(Laplacian, LinearFunctionsAreHarmonicInsideAFlatSheet) {
  TriangleMesh mesh = shapes::grid(8);
  for (int v = 0; v < mesh.vertex_count(); ++v) mesh.V(v, 0) += 1.7 * mesh.V(v, 1);
  const Laplacian laplacian = compute_laplacian(mesh, {.mollify = 0}).value();
  EXPECT_GT(laplacian.flips, 0);
  const Eigen::VectorXd Lu = laplacian.L * (2 * mesh.V.col(0) - mesh.V.col(1));
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    bool boundary = false;
    for_each_outgoing(mesh, v, [&](int h) { boundary |= mesh.twin[static_cast<size_t>(h)] < 0; });
    if (!boundary) {
      EXPECT_NEAR(Lu[v], 0, 1e-12) << "vertex " << v;  // rounding
    }
  }
}

TEST(Laplacian, StiffnessIgnoresScaleAndMassGrowsWithItsSquare) {
  TriangleMesh mesh = sliver_sphere();
  const Laplacian one = compute_laplacian(mesh).value();
  mesh.V *= 8;  // a power of two, so that nothing rounds
  const Laplacian eight = compute_laplacian(mesh).value();
  EXPECT_EQ((one.L - eight.L).norm(), 0);
  EXPECT_LT((64 * one.mass - eight.mass).norm(), 1e-15 * eight.mass.norm());
}

TEST(Laplacian, MassSumsToTheArea) {
  const TriangleMesh mesh = shapes::torus(2, 1, 12, 8);
  const Laplacian laplacian = compute_laplacian(mesh, {.mollify = 0}).value();
  EXPECT_NEAR(laplacian.mass.sum(), total_area(mesh), 1e-12 * total_area(mesh));  // rounding
}

TEST(Laplacian, RefusesAPoint) {
  TriangleMesh mesh = shapes::tetrahedron();
  mesh.V.setZero();
  const auto laplacian = compute_laplacian(mesh);
  ASSERT_FALSE(laplacian);
  EXPECT_EQ(laplacian.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace crosspatch
