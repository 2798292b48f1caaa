#include "param/parametrize.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "param/symmetric_dirichlet.hpp"
#include "param/tutte.hpp"
#include "shapes.hpp"

namespace crosspatch {
namespace {

/// A square patch with bumps of the given height.
TriangleMesh bumpy(int n, double height) {
  TriangleMesh mesh = split_chords(shapes::grid(n)).mesh;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    mesh.V(v, 2) = height * std::sin(7 * mesh.V(v, 0)) * std::sin(9 * mesh.V(v, 1));
  return mesh;
}

MatrixX2d square_start(const TriangleMesh& mesh, TutteWeights weights = TutteWeights::kUniform) {
  const std::vector<int> loop = boundary_loops(mesh)[0];
  MatrixX2d p(static_cast<int>(loop.size()), 2);
  for (int i = 0; i < p.rows(); ++i)
    p.row(i) = mesh.V.row(loop[static_cast<std::size_t>(i)]).head<2>();
  return tutte_embedding(mesh, loop, p, {.weights = weights}).value();
}

TEST(SymmetricDirichlet, DerivativesMatchDifferences) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const TriangleMesh mesh = shapes::tetrahedron();
  const RestTriangle rest = rest_triangles(mesh, 0.7)[0];
  for (int trial = 0; trial < 50; ++trial) {
    std::array<Vector2d, 3> p;
    Eigen::Matrix2d J;
    do {
      for (Vector2d& q : p) q = {normal(random), normal(random)};
      J = jacobian(rest, p[0], p[1], p[2]);
    } while (J.determinant() < 0.1);
    const DirichletTerm term = symmetric_dirichlet(rest, J);
    const Eigen::Matrix<double, 3, 2> G = corner_gradients(rest);
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 2; ++i) {
        Eigen::Vector4d dJ = Eigen::Vector4d::Zero();
        dJ.segment<2>(2 * i) = G.row(k).transpose();
        const Eigen::Matrix<double, 8, 1> analytic = term.by_jacobian * dJ;
        constexpr double kStep = 1e-5;
        const auto residual = [&](double shift) {
          std::array<Vector2d, 3> q = p;
          q[static_cast<std::size_t>(k)][i] += shift;
          return symmetric_dirichlet(rest, jacobian(rest, q[0], q[1], q[2])).residual;
        };
        const Eigen::Matrix<double, 8, 1> numeric =
            (residual(kStep) - residual(-kStep)) / (2 * kStep);
        // Central differences: an error of step^2 times the third derivative, det >= 0.1.
        EXPECT_LT((analytic - numeric).norm(), 1e-5 * (1 + analytic.norm()));
      }
  }
}

TEST(SymmetricDirichlet, EnergyIsFourForRotationsOnly) {
  const TriangleMesh mesh = shapes::grid(5);
  const Eigen::Rotation2Dd turn(0.3);
  const MatrixX2d uv = mesh.V.leftCols<2>() * turn.toRotationMatrix().transpose();
  const auto rest = rest_triangles(mesh);
  EXPECT_NEAR(symmetric_dirichlet_energy(rest, mesh.F, uv), 4, 1e-12);
  // Scaling by s gives 2 s^2 + 2 / s^2.
  EXPECT_NEAR(symmetric_dirichlet_energy(rest, mesh.F, 2 * uv), 8.5, 1e-12);
  EXPECT_EQ(symmetric_dirichlet_energy(rest, mesh.F, -uv.rowwise().reverse()), HUGE_VAL);
}

TEST(SymmetricDirichlet, SingularValuesOfAShear) {
  Eigen::Matrix2d J;
  J << 2, 1, 0, 3;
  const Vector2d s = singular_values(J);
  EXPECT_NEAR(s[0] * s[1], 6, 1e-14);
  EXPECT_NEAR(s.squaredNorm(), 14, 1e-13);
}

TEST(Parametrize, AFlatSquareComesBackAsAnIsometry) {
  const TriangleMesh mesh = bumpy(12, 0);
  const auto r = parametrize(mesh, square_start(mesh), {.stiffening_rounds = 0});
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_GT(r->energy_before, 4.001);
  EXPECT_NEAR(r->energy_after, 4, 1e-6);  // the tolerance of the rounds
  EXPECT_LT((r->uv - mesh.V.leftCols<2>()).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Parametrize, LowersTheEnergyWithoutFolds) {
  for (const PatchBoundary boundary :
       {PatchBoundary::kFixed, PatchBoundary::kSliding, PatchBoundary::kFree})
    for (const int stiffening : {0, 6}) {
      const TriangleMesh mesh = bumpy(20, 0.15);
      const auto r = parametrize(
          mesh, square_start(mesh), {.boundary = boundary, .stiffening_rounds = stiffening});
      ASSERT_TRUE(r) << r.error().message;
      EXPECT_TRUE(r->converged);
      EXPECT_LT(r->energy_after, r->energy_before);
      EXPECT_GE(r->energy_after, 4);
      EXPECT_TRUE(folded_faces(mesh, r->uv).empty());
    }
}

TEST(Parametrize, MoreFreedomGivesLessEnergy) {
  const TriangleMesh mesh = bumpy(16, 0.15);
  const MatrixX2d start = square_start(mesh);
  double last = HUGE_VAL;
  for (const PatchBoundary boundary :
       {PatchBoundary::kFixed, PatchBoundary::kSliding, PatchBoundary::kFree}) {
    const auto r = parametrize(mesh, start, {.boundary = boundary, .stiffening_rounds = 0});
    ASSERT_TRUE(r);
    EXPECT_LT(r->energy_after, last);
    last = r->energy_after;
  }
}

TEST(Parametrize, BoundaryKeepsItsPromise) {
  const TriangleMesh mesh = bumpy(10, 0.2);
  const MatrixX2d start = square_start(mesh);
  const auto fixed = parametrize(mesh, start);
  const auto sliding = parametrize(mesh, start, {.boundary = PatchBoundary::kSliding});
  ASSERT_TRUE(fixed && sliding);
  for (const std::vector<int> loop = boundary_loops(mesh)[0]; const int v : loop) {
    EXPECT_EQ(fixed->uv.row(v), start.row(v));
    for (int i = 0; i < 2; ++i) {
      const bool on_side = start(v, i) == 0 || start(v, i) == 1;
      EXPECT_TRUE(!on_side || sliding->uv(v, i) == start(v, i));
    }
  }
}

TEST(Parametrize, StiffeningLowersTheWorstStretch) {
  const TriangleMesh mesh = bumpy(24, 0.4);
  const MatrixX2d start = square_start(mesh);
  const auto plain = parametrize(mesh, start, {.stiffening_rounds = 0});
  const auto stiff = parametrize(mesh, start);
  ASSERT_TRUE(plain && stiff);
  EXPECT_EQ(plain->largest_stiffness, 1);
  EXPECT_GT(stiff->largest_stiffness, 1);
  EXPECT_LT(stiff->worst_stretch_after, plain->worst_stretch_after);
}

TEST(Parametrize, SurvivesAStartWithTinyTriangles) {
  // A tall spike: its Tutte image shrinks the tip by orders of magnitude.
  TriangleMesh mesh = split_chords(shapes::grid(24)).mesh;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const double r2 = (mesh.V.row(v).head<2>() - Eigen::RowVector2d(0.5, 0.5)).squaredNorm();
    mesh.V(v, 2) = 8 * std::exp(-40 * r2);
  }
  const auto r = parametrize(mesh, square_start(mesh, TutteWeights::kSymmetric));
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_TRUE(folded_faces(mesh, r->uv).empty());
  EXPECT_LT(r->energy_after, r->energy_before);
}

TEST(Parametrize, FoldedStartIsNamed) {
  const TriangleMesh mesh = shapes::grid(3);
  MatrixX2d uv = mesh.V.leftCols<2>();
  uv.row(5) = uv.row(0);
  EXPECT_EQ(parametrize(mesh, uv).error().code, ErrorCode::kBadInput);
  EXPECT_EQ(parametrize(mesh, uv.topRows(3)).error().message, "patch: 3 positions for 16 vertices");
}

}  // namespace
}  // namespace crosspatch
