#include "core/chirality.hpp"

#include <gtest/gtest.h>

#include "core/creatures.hpp"

namespace crosspatch {
namespace {

TEST(Chirality, FieldsOfAMirroredSurfaceHaveTheOtherSign) {
  const TriangleMesh mesh = shapes::creature(3);
  MatrixX3d V = mesh.V;
  V.col(0) *= -1;
  MatrixX3i F = mesh.F;
  F.col(1).swap(F.col(2));
  const TriangleMesh mirrored = make_mesh(V, F).value();
  const auto fields = [](const TriangleMesh& m) {
    // Edges whose four corners lie on a circle have two Delaunay flips; without flips both agree.
    return chirality_fields(m, compute_spectrum(m, {.laplacian = {.delaunay = false}}).value())
        .value();
  };
  const Eigen::MatrixXd a = fields(mesh), b = fields(mirrored);
  ASSERT_GT(a.norm(), 1);
  EXPECT_LT((a + b).norm(), 1e-9 * a.norm());  // rounding
}

TEST(Chirality, FieldsHaveMeanSquareOne) {
  const TriangleMesh mesh = shapes::creature(3);
  const Spectrum spectrum = compute_spectrum(mesh, {}).value();
  const Eigen::MatrixXd fields = chirality_fields(mesh, spectrum).value();
  for (int k = 0; k < fields.cols(); ++k)
    EXPECT_NEAR(spectrum.mass.dot(fields.col(k).cwiseAbs2()), 1, 1e-9) << k;
}

}  // namespace
}  // namespace crosspatch
