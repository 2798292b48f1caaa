#include "param/symmetric_dirichlet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crosspatch {

std::vector<RestTriangle> rest_triangles(const TriangleMesh& mesh, double scale) {
  constexpr double kFlattest = 1e-4, kSmallest = 1e-6;
  const double size =
      scale * std::sqrt(std::max(total_area(mesh) / std::max(mesh.face_count(), 1), 1e-300));
  std::vector<RestTriangle> rest(static_cast<std::size_t>(mesh.face_count()));
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3d a = mesh.position(mesh.F(f, 0));
    const Vector3d b = scale * (mesh.position(mesh.F(f, 1)) - a);
    const Vector3d c = scale * (mesh.position(mesh.F(f, 2)) - a);
    const double longest = std::max({b.norm(), c.norm(), (b - c).norm(), kSmallest * size});
    // First edge on the x axis, third corner at (x, y) above it.
    const double length = std::max(b.norm(), kFlattest * longest);
    const double x = b.norm() > 0 ? c.dot(b) / b.norm() : c.norm();
    const double y = std::max(b.norm() > 0 ? b.cross(c).norm() / b.norm() : 0, kFlattest * longest);
    RestTriangle& r = rest[static_cast<std::size_t>(f)];
    r.inverse_edges << 1 / length, -x / (length * y), 0, 1 / y;
    r.area = length * y / 2;
  }
  return rest;
}

Eigen::Matrix2d jacobian(const RestTriangle& rest,
                         const Vector2d& a,
                         const Vector2d& b,
                         const Vector2d& c) {
  Eigen::Matrix2d edges;
  edges << b - a, c - a;
  return edges * rest.inverse_edges;
}

DirichletTerm symmetric_dirichlet(const RestTriangle& rest, const Eigen::Matrix2d& J) {
  const double root = std::sqrt(rest.area);
  const Eigen::Matrix2d inverse = J.inverse();
  DirichletTerm t;
  t.by_jacobian.setZero();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      t.residual[2 * i + j] = root * J(i, j);
      t.residual[4 + 2 * i + j] = root * inverse(i, j);
      t.by_jacobian(2 * i + j, 2 * i + j) = root;
      // d J^-1 = -J^-1 dJ J^-1 with dJ = e_i e_j^T.
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
          t.by_jacobian(4 + 2 * k + l, 2 * i + j) = -root * inverse(k, i) * inverse(j, l);
    }
  return t;
}

Eigen::Matrix<double, 3, 2> corner_gradients(const RestTriangle& rest) {
  Eigen::Matrix<double, 3, 2> G;
  G.bottomRows<2>() = rest.inverse_edges;
  G.row(0) = -rest.inverse_edges.colwise().sum();
  return G;
}

double symmetric_dirichlet_energy(const std::vector<RestTriangle>& rest,
                                  const MatrixX3i& F,
                                  const MatrixX2d& uv) {
  double energy = 0, area = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto f = static_cast<Eigen::Index>(i);
    const Eigen::Matrix2d J = jacobian(rest[i], uv.row(F(f, 0)), uv.row(F(f, 1)), uv.row(F(f, 2)));
    const double det = J.determinant();
    if (!(det > 0)) return std::numeric_limits<double>::infinity();
    // |J^-1|^2 = |J|^2 / det^2 in two dimensions.
    energy += rest[i].area * J.squaredNorm() * (1 + 1 / (det * det));
    area += rest[i].area;
  }
  return energy / area;
}

Vector2d singular_values(const Eigen::Matrix2d& J) {
  // |J|^2 = s1^2 + s2^2 and det = s1 s2 give the sum and the difference of the two.
  const double square = J.squaredNorm(), det = J.determinant();
  const double sum = std::sqrt(std::max(square + 2 * det, 0.0));
  const double difference = std::sqrt(std::max(square - 2 * det, 0.0));
  const double larger = (sum + difference) / 2;
  return {larger, larger > 0 ? det / larger : 0};
}

}  // namespace crosspatch
