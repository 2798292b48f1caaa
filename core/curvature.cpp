#include "core/curvature.hpp"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <numbers>

#include "core/laplacian.hpp"

namespace crosspatch {
namespace {

/// Integrated Gaussian curvature: 2 pi (pi on a boundary) minus the angles around each vertex.
Eigen::VectorXd angle_defects(const TriangleMesh& mesh) {
  Eigen::VectorXd defect = Eigen::VectorXd::Constant(mesh.vertex_count(), 2 * std::numbers::pi);
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin[static_cast<std::size_t>(h)] < 0) defect[mesh.from(h)] = std::numbers::pi;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = mesh.position(mesh.F(f, k));
      const Vector3d u = mesh.position(mesh.F(f, (k + 1) % 3)) - p,
                     v = mesh.position(mesh.F(f, (k + 2) % 3)) - p;
      defect[mesh.F(f, k)] -= std::atan2(u.cross(v).norm(), u.dot(v));
    }
  return defect;
}

/// Integrated mean curvature, twice: the normal part of L V.
Eigen::VectorXd mean_curvatures(const TriangleMesh& mesh, const SparseMatrix& L) {
  MatrixX3d normal = MatrixX3d::Zero(mesh.vertex_count(), 3);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3d a = mesh.position(mesh.F(f, 0)), b = mesh.position(mesh.F(f, 1)),
                   c = mesh.position(mesh.F(f, 2));
    const Vector3d n = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normal.row(mesh.F(f, k)) += n.transpose();
  }
  normal.rowwise().normalize();
  return (L * mesh.V).cwiseProduct(normal).rowwise().sum();
}

Eigen::VectorXd standardized(const Eigen::VectorXd& field, const Eigen::VectorXd& mass) {
  const double total = mass.sum();
  const double magnitude = mass.dot(field.cwiseAbs()) / total;
  if (!(magnitude > 0)) return Eigen::VectorXd::Zero(field.size());
  Eigen::VectorXd x = (field / magnitude).array().asinh();
  x.array() -= mass.dot(x) / total;
  const double deviation = std::sqrt(mass.dot(x.cwiseAbs2()) / total);
  constexpr double kConstant = 0.05;  // below it the rest is the triangulation's noise
  return deviation > kConstant ? Eigen::VectorXd(x / deviation)
                               : Eigen::VectorXd::Zero(field.size());
}

}  // namespace

Result<Eigen::MatrixXd> curvature_fields(const TriangleMesh& mesh,
                                         const CurvatureOptions& options) {
  const auto laplacian = compute_laplacian(mesh);
  if (!laplacian) return tl::unexpected(laplacian.error());
  const double area = laplacian->mass.sum();
  Eigen::MatrixXd integrated(mesh.vertex_count(), 2);
  integrated << mean_curvatures(mesh, laplacian->L), angle_defects(mesh);
  Eigen::MatrixXd fields(mesh.vertex_count(), 0);
  for (const double time : options.times) {
    // Two implicit steps of half the time: no ringing.
    SparseMatrix A = 0.5 * time * area * laplacian->L;
    A.diagonal() += laplacian->mass;
    const Eigen::SimplicialLDLT<SparseMatrix> solver(A);
    if (solver.info() != Eigen::Success)
      return fail(ErrorCode::kNumerical, "curvature: the smoothing matrix cannot be factorized");
    fields.conservativeResize(Eigen::NoChange, fields.cols() + 2);
    for (int k = 0; k < 2; ++k) {
      const Eigen::VectorXd once = solver.solve(integrated.col(k));
      const Eigen::VectorXd smooth = solver.solve(laplacian->mass.cwiseProduct(once));
      fields.col(fields.cols() - 2 + k) = standardized(smooth, laplacian->mass);
    }
  }
  return fields;
}

Result<Eigen::VectorXd> integrated_mean_curvature(const TriangleMesh& mesh) {
  return compute_laplacian(mesh).map(
      [&](const Laplacian& laplacian) { return mean_curvatures(mesh, laplacian.L); });
}

}  // namespace crosspatch
