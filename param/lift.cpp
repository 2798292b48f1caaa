#include "param/lift.hpp"

#include <cmath>
#include <numbers>

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Radius of the sphere of area 1.
const double kRadius = 1 / std::sqrt(4 * std::numbers::pi);

}  // namespace

Vector3d SphereLift::point(const Vector3d& x, int& /*face*/) const {
  return kRadius * x;
}

Eigen::Matrix3d SphereLift::derivative(const Vector3d& /*x*/, int /*face*/) const {
  return kRadius * Eigen::Matrix3d::Identity();
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
