#include "core/spectrum.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace crosspatch {
namespace {

using std::numbers::pi;

TEST(Spectrum, OfTheSphereIsThatOfSphericalHarmonics) {
  const Spectrum spectrum =
      compute_spectrum(shapes::icosphere(4), {.count = 25}).value();  // 2562 vertices
  // l (l + 1) with multiplicity 2 l + 1, times the area 4 pi; the mesh resolves l = 4 to ~1 %.
  for (int l = 0, i = 0; l < 5; ++l)
    for (int m = 0; m < 2 * l + 1; ++m, ++i)
      EXPECT_NEAR(spectrum.values[i], 4 * pi * l * (l + 1), 1e-8 + 0.01 * 4 * pi * l * (l + 1));
}

TEST(Spectrum, SatisfiesItsInvariantsAndTheEigenvalueEquation) {
  for (const TriangleMesh& mesh : {shapes::tetrahedron(),
                                   shapes::icosphere(1),
                                   shapes::icosphere(3),
                                   shapes::grid(20),
                                   shapes::torus(3, 1, 40, 16)}) {
    const Spectrum spectrum = compute_spectrum(mesh, {.count = 60}).value();
    EXPECT_EQ(spectrum.count(), std::min(60, mesh.vertex_count()));
    EXPECT_TRUE(validate(spectrum)) << validate(spectrum).error().message;
    EXPECT_LT(spectrum.residual, 1e-6);  // solver tolerance over the eigenvalue spread
    EXPECT_NEAR(spectrum.values[0], 0, 1e-8);
    EXPECT_GT(spectrum.values[1], 1);
  }
}

TEST(Spectrum, SupernodalAndSimplicialFactorsAgree) {
  const TriangleMesh mesh = shapes::torus(3, 1, 60, 20);
  const Spectrum simplicial = compute_spectrum(mesh, {.count = 20}).value();
  const Spectrum supernodal = compute_spectrum(mesh, {.count = 20, .supernodal_from = 0}).value();
  EXPECT_LT((simplicial.values - supernodal.values).norm(), 1e-6);  // solver tolerance
}

TEST(Spectrum, IgnoresScaleAndRepeatsBitForBit) {
  TriangleMesh mesh = shapes::torus(3, 1, 40, 16);
  const Spectrum one = compute_spectrum(mesh, {.count = 12}).value();
  const Spectrum again = compute_spectrum(mesh, {.count = 12}).value();
  EXPECT_EQ(one.functions, again.functions);
  mesh.V *= 4;  // a power of two, so that nothing rounds
  EXPECT_EQ(one.values, compute_spectrum(mesh, {.count = 12}).value().values);
}

TEST(Spectrum, RefusesADisconnectedSurface) {
  const TriangleMesh one = shapes::tetrahedron();
  MatrixX3d V(8, 3);
  V << one.V, one.V.array() + 5;
  MatrixX3i F(8, 3);
  F << one.F, one.F.array() + 4;
  const auto spectrum = compute_spectrum(make_mesh(V, F).value());
  ASSERT_FALSE(spectrum);
  EXPECT_EQ(spectrum.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace crosspatch
