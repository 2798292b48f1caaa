#include "param/lift.hpp"

#include <cmath>
#include <numbers>

namespace crosspatch {

using Matrix32 = Eigen::Matrix<double, 3, 2>;

namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

Matrix32 tangent_basis(const Vector3d& x) {
  const Vector3d axis = std::abs(x[0]) < 0.6 ? Vector3d::UnitX() : Vector3d::UnitY();
  Matrix32 b;
  b.col(0) = x.cross(axis).normalized();
  b.col(1) = x.normalized().cross(b.col(0));
  return b;
}

/// Radius of the sphere of area 1.
const double kRadius = 1 / std::sqrt(4 * std::numbers::pi);

}  // namespace

Vector3d SphereLift::point(const Vector3d& x, int& /*face*/) const {
  return kRadius * x;
}

Lift::Frame SphereLift::frame(const Vector3d& x, int /*face*/) const {
  const Matrix32 basis = tangent_basis(x);
  return {basis / kRadius, basis};
}

Vector3d SphereLift::walk(const Vector3d& x, int& /*face*/, const Vector3d& d) const {
  return (x + d / kRadius).normalized();
}

Vector3d MeshLift::barycentric(const Vector3d& x, int face) const {
  const auto corner = mesh_->F.row(face);
  const Vector3d a = X_->row(corner[0]), b = X_->row(corner[1]), c = X_->row(corner[2]);
  // det(x, b, c) by differences from x: small faces lose no digits to the common unit length.
  const Vector3d p = a - x, q = b - x, r = c - x;
  Vector3d w(x.dot(q.cross(r)), x.dot(r.cross(p)), x.dot(p.cross(q)));
  w = w.cwiseMax(0);
  const double sum = w.sum();
  return sum > 0 ? Vector3d(w / sum) : Vector3d::Constant(1.0 / 3);
}

Eigen::Matrix3d MeshLift::derivative(const Vector3d& x, int face) const {
  Eigen::Matrix3d corners, values;
  for (int k = 0; k < 3; ++k) {
    corners.col(k) = X_->row(mesh_->F(face, k)).transpose();
    values.col(k) = mesh_->V.row(mesh_->F(face, k)).transpose();
  }
  const Eigen::Matrix3d inverse = corners.inverse();
  const Vector3d c = inverse * x;
  const double sum = c.sum();
  return values / sum * (inverse - c / sum * inverse.colwise().sum());
}

Lift::Frame MeshLift::frame(const Vector3d& x, int face) const {
  Frame frame;
  frame.on_surface = plane(face);
  const Matrix32 basis = tangent_basis(x);
  const Eigen::Matrix2d M = frame.on_surface.transpose() * derivative(x, face) * basis;
  frame.on_sphere = basis * M.inverse();
  return frame;
}

Matrix32 MeshLift::plane(int face) const {
  const Vector3d e = mesh_->position(mesh_->F(face, 1)) - mesh_->position(mesh_->F(face, 0)),
                 f = mesh_->position(mesh_->F(face, 2)) - mesh_->position(mesh_->F(face, 0));
  Matrix32 axes;
  axes.col(0) = e.normalized();
  axes.col(1) = e.cross(f).cross(e).normalized();
  return axes;
}

Lift::Values MeshLift::values(const Vector3d& x, int face) const {
  if (fields_ == nullptr) return {};
  const Vector3d bary = barycentric(x, face);
  Values sum = Values::Zero(fields_->cols());
  for (int k = 0; k < 3; ++k) sum += bary[k] * fields_->row(mesh_->F(face, k)).transpose();
  return sum;
}

Lift::Rates MeshLift::rates(int face) const {
  if (fields_ == nullptr) return {};
  const auto corner = mesh_->F.row(face);
  const Matrix32 axes = plane(face);
  Eigen::Matrix2d E;
  E << axes.transpose() * (mesh_->position(corner[1]) - mesh_->position(corner[0])),
      axes.transpose() * (mesh_->position(corner[2]) - mesh_->position(corner[0]));
  Rates differences(fields_->cols(), 2);
  for (int k = 0; k < 2; ++k)
    differences.col(k) = (fields_->row(corner[k + 1]) - fields_->row(corner[0])).transpose();
  return differences * E.inverse();
}

Vector3d MeshLift::walk(const Vector3d& x, int& face, const Vector3d& direction) const {
  face = locate(x, face);
  Vector3d bary = barycentric(x, face), d = direction;
  const auto position = [&](int corner) { return mesh_->position(mesh_->F(face, corner)); };
  for (int steps = 0; steps < mesh_->face_count(); ++steps) {
    // How the coordinates change along d.
    Matrix32 E;
    E << position(1) - position(0), position(2) - position(0);
    const Vector2d c = (E.transpose() * E).inverse() * (E.transpose() * d);
    const Vector3d rate(-c[0] - c[1], c[0], c[1]);
    if (!rate.allFinite()) break;
    double t = 1;
    int leave = -1;  // the corner whose coordinate falls to zero first
    for (int k = 0; k < 3; ++k)
      if (rate[k] < 0 && bary[k] < -t * rate[k]) t = bary[k] / -rate[k], leave = k;
    bary = (bary + t * rate).cwiseMax(0);
    if (leave < 0) break;
    bary[leave] = 0;
    bary /= bary.sum();
    const int h = 3 * face + (leave + 1) % 3, twin = mesh_->twin[at(h)];
    if (twin < 0) break;
    const auto normal = [&] {
      return Vector3d((position(1) - position(0)).cross(position(2) - position(0)).normalized());
    };
    const Vector3d edge = (position((leave + 2) % 3) - position((leave + 1) % 3)).normalized();
    const double along = (1 - t) * d.dot(edge), across = (1 - t) * d.dot(edge.cross(normal()));
    const double from = bary[(leave + 1) % 3], to = bary[(leave + 2) % 3];
    face = twin / 3;
    bary[twin % 3] = to;
    bary[(twin + 1) % 3] = from;
    bary[(twin + 2) % 3] = 0;
    d = along * edge + across * edge.cross(normal());
  }
  Vector3d result = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) result += bary[k] * X_->row(mesh_->F(face, k)).transpose();
  return result.normalized();
}

int MeshLift::locate(const Vector3d& x, int face) const {
  const auto side = [&](int h) {
    const Vector3d a = X_->row(mesh_->from(h)), b = X_->row(mesh_->to(h));
    return x.dot((a - x).cross(b - x));
  };
  // The walk starts at another side of each face it enters, which breaks the cycles a visibility
  // walk can fall into.
  int turn = 0;
  for (int steps = 0; steps < mesh_->face_count(); ++steps) {
    int leave = -1;
    for (int j = 0; j < 3 && leave < 0; ++j) {
      const int h = 3 * face + (j + turn) % 3;
      if (side(h) < 0 && mesh_->twin[at(h)] >= 0) leave = h;
    }
    if (leave < 0) {
      // Three non-negative sides also hold at the face opposite on the sphere.
      if (X_->row(mesh_->F(face, 0)).dot(x) > -0.9) return face;
      leave = 3 * face + turn % 3;
    }
    face = mesh_->twin[at(leave)] / 3;
    turn = (turn + 1 + steps / 64) % 3;
  }
  // The walk did not end: the face that x violates least.
  int best = 0;
  double best_side = -1e300;
  for (int f = 0; f < mesh_->face_count(); ++f) {
    const double worst = std::min({side(3 * f), side(3 * f + 1), side(3 * f + 2)});
    if (X_->row(mesh_->F(f, 0)).dot(x) > 0 && worst > best_side) best = f, best_side = worst;
  }
  return best;
}

SurfacePoint MeshLift::surface_point(const Vector3d& x, int& face) const {
  face = locate(x, face);
  return {face, barycentric(x, face)};
}

Vector3d MeshLift::point(const Vector3d& x, int& face) const {
  return position(*mesh_, surface_point(x, face));
}

}  // namespace crosspatch
