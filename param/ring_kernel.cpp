#include "param/ring_kernel.hpp"

namespace crosspatch {
namespace {

using Polygon = std::vector<Vector2d>;

/// The part of a convex polygon where n . p + c > 0.
Polygon clip(const Polygon& polygon, const Vector2d& n, double c) {
  Polygon inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double a = n.dot(p) + c, b = n.dot(q) + c;
    if (a > 0) inside.push_back(p);
    if ((a > 0) != (b > 0)) inside.push_back(p + (q - p) * (a / (a - b)));
  }
  return inside;
}

}  // namespace

RingKernel::RingKernel(const MatrixX3d& X,
                       const std::vector<std::pair<int, int>>& ring,
                       const Vector3d& center,
                       int at_center)
    : center_(center), e1_(center.unitOrthogonal()), e2_(center.cross(e1_)) {
  constexpr double kReach = 4;
  corners_ = {{-kReach, -kReach}, {kReach, -kReach}, {kReach, kReach}, {-kReach, kReach}};
  for (const auto& [a, b] : ring) {
    // Differences from the centre keep the digits of small rings.
    const Vector3d p = X.row(a).transpose(), q = X.row(b).transpose();
    const Vector3d n = p.cross(q - p);
    const double length = n.norm();
    const double c =
        a == at_center || b == at_center ? 0 : center.dot((p - center).cross(q - center));
    if (length > 0)
      corners_ = clip(corners_, Vector2d(n.dot(e1_), n.dot(e2_)) / length, c / length);
    if (corners_.size() < 3) {
      corners_.clear();
      return;
    }
  }
}

Vector2d RingKernel::centroid() const {
  double area = 0;
  Vector2d sum = Vector2d::Zero();
  for (std::size_t i = 1; i + 1 < corners_.size(); ++i) {
    const Vector2d u = corners_[i] - corners_[0], v = corners_[i + 1] - corners_[0];
    const double a = u[0] * v[1] - u[1] * v[0];
    area += a;
    sum += a * (corners_[0] + corners_[i] + corners_[i + 1]) / 3;
  }
  return area > 0 ? Vector2d(sum / area) : corners_[0];
}

}  // namespace crosspatch
