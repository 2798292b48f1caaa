#include "tools/view.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <array>
#include <limits>
#include <numbers>

namespace crosspatch {
namespace {

constexpr std::array<std::string_view, 7> kViewNames = {
    "front", "back", "left", "right", "top", "bottom", "quarter"};

/// The camera axes for something that stands straight: right along x, up along y, front along z.
Eigen::Matrix3d standing_axes(View view) {
  constexpr double kDegree = std::numbers::pi / 180;
  const auto turned = [](double y_degrees, double x_degrees) -> Eigen::Matrix3d {
    return (Eigen::AngleAxisd(x_degrees * kDegree, Vector3d::UnitX()) *
            Eigen::AngleAxisd(y_degrees * kDegree, Vector3d::UnitY()))
        .toRotationMatrix();
  };
  switch (view) {
    case View::kFront:
      return turned(0, 0);
    case View::kBack:
      return turned(180, 0);
    case View::kLeft:
      return turned(90, 0);
    case View::kRight:
      return turned(-90, 0);
    case View::kTop:
      return turned(0, 90);
    case View::kBottom:
      return turned(0, -90);
    case View::kQuarter:
      return turned(-35, 20);
  }
  return Eigen::Matrix3d::Identity();
}

Vector3d with_positive_largest(const Vector3d& axis) {
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Vector3d(-axis) : axis;
}

}  // namespace

Frame axis_frame(char up) {
  Frame frame;
  if (up == 'x')
    frame << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  else if (up == 'z')
    frame << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  else
    frame.setIdentity();
  return frame;
}

Frame principal_frame(const MatrixX3d& points) {
  const MatrixX3d centred = points.rowwise() - points.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(centred.transpose() * centred);
  Frame frame;  // eigenvalues ascend
  frame.row(0) = with_positive_largest(solver.eigenvectors().col(2)).transpose();
  frame.row(1) = with_positive_largest(solver.eigenvectors().col(1)).transpose();
  frame.row(2) = frame.row(0).cross(frame.row(1));
  return frame;
}

Eigen::Matrix3d best_rotation(const MatrixX3d& points, const MatrixX3d& onto) {
  const Eigen::Matrix3d moments = (onto.rowwise() - onto.colwise().mean()).transpose() *
                                  (points.rowwise() - points.colwise().mean());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vector3d(1, 1, handedness).asDiagonal() * svd.matrixV().transpose();
}

Result<View> parse_view(std::string_view name) {
  if (name == "side") return View::kRight;
  for (std::size_t i = 0; i < kViewNames.size(); ++i)
    if (name == kViewNames[i]) return static_cast<View>(i);
  return fail(
      ErrorCode::kBadInput,
      fmt::format("view '{}': known are front, back, left, right, side, top, bottom, quarter",
                  name));
}

std::string_view view_name(View view) {
  return kViewNames[static_cast<std::size_t>(view)];
}

Eigen::Matrix3d view_axes(const Frame& frame, View view) {
  return standing_axes(view) * frame;
}

Camera fit_camera(
    const Scene& scene, const Eigen::Matrix3d& axes, int width, int height, int margin) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Array3d low = Eigen::Array3d::Constant(kInfinity), high = -low;
  const auto include = [&](const Vector3d& p, double radius) {
    const Eigen::Array3d q = axes * p;
    low = low.min(q - radius);
    high = high.max(q + radius);
  };
  for (const Surface& surface : scene.surfaces)
    for (int f = 0; f < surface.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) include(surface.V.row(surface.F(f, k)).transpose(), 0);
  for (const Rod& rod : scene.rods) {
    include(rod.a, rod.radius);
    include(rod.b, rod.radius);
  }
  Camera camera{.axes = axes};
  if (!(low <= high).all()) return camera;
  camera.centre = axes.transpose() * ((low + high) / 2).matrix();
  const double across = (high.x() - low.x()) / std::max(1, width - 2 * margin);
  const double up = (high.y() - low.y()) / std::max(1, height - 2 * margin);
  camera.pixel_size = std::max({across, up, std::numeric_limits<double>::min()});
  return camera;
}

}  // namespace crosspatch
