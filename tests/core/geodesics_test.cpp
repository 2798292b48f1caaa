#include "core/geodesics.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace crosspatch {
namespace {

TEST(Geodesics, OnAFlatConvexSheetAreEuclidean) {
  const TriangleMesh mesh = shapes::grid(20);
  const std::vector<int> sources{0, 217};
  const Eigen::MatrixXd D = geodesic_distances(mesh, sources);
  for (int j = 0; j < 2; ++j)
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      const double exact = (mesh.V.row(v) - mesh.V.row(sources[static_cast<size_t>(j)])).norm();
      // Never shorter than the truth; the front's order of arrival costs up to 1 %.
      EXPECT_GE(D(v, j), exact - 1e-12);
      EXPECT_LE(D(v, j), 1.01 * exact + 1e-12);
    }
}

TEST(Geodesics, OnTheSphereAreGreatCircleArcs) {
  const TriangleMesh mesh = shapes::icosphere(4);
  const Eigen::MatrixXd D = geodesic_distances(mesh, {0, 700});
  double sum = 0;
  for (int j = 0; j < 2; ++j)
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      const double cosine = mesh.V.row(v).dot(mesh.V.row(j == 0 ? 0 : 700));
      const double exact = std::acos(std::clamp(cosine, -1.0, 1.0));
      EXPECT_NEAR(D(v, j), exact, 0.02 * exact + 1e-7);
      if (exact > 0) sum += std::abs(D(v, j) / exact - 1);
    }
  EXPECT_LT(sum / (2 * mesh.vertex_count()), 0.005);  // mesh resolution and method
}

TEST(Geodesics, AreNearlySymmetricAndObeyTheTriangleInequality) {
  TriangleMesh mesh = shapes::torus(3, 1, 40, 16);
  const std::vector<int> sources{0, 50, 333, 601};
  const Eigen::MatrixXd D = geodesic_distances(mesh, sources);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const double ij = D(sources[static_cast<size_t>(i)], j);
      EXPECT_NEAR(ij, D(sources[static_cast<size_t>(j)], i), 0.01 * ij);  // method
      for (int v = 0; v < mesh.vertex_count(); ++v)
        EXPECT_LE(D(v, j), 1.02 * (D(v, i) + ij) + 1e-12);
    }
}

TEST(Geodesics, ToASetAreTheLeastOfThoseToItsMembers) {
  const TriangleMesh mesh = shapes::icosphere(3);
  const Eigen::MatrixXd D = geodesic_distances(mesh, {3, 100, 500});
  const Eigen::VectorXd set = geodesic_distance_to_set(mesh, {3, 100, 500});
  // Where two fronts meet, unfolding between them may differ by a fraction of an edge.
  EXPECT_LT((set - D.rowwise().minCoeff()).cwiseAbs().maxCoeff(), 0.05);
}

}  // namespace
}  // namespace crosspatch
