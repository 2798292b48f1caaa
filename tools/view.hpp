#pragma once

#include <string_view>

#include "core/result.hpp"
#include "tools/raster.hpp"

namespace crosspatch {

/// How a thing stands: rows are the right, the up and the front (towards the viewer) of the picture
/// that shows its front; an orthonormal, right-handed frame.
using Frame = Eigen::Matrix3d;

/// Up along a coordinate axis: 'x' (front along z), 'y' (front along z, as in glTF) or 'z' (front
/// along -y).
Frame axis_frame(char up);

/// Principal axes of the points (#V x 3): the longest to the right, the second up. Each of these
/// two points the way in which its largest coordinate is positive; the front follows from them.
Frame principal_frame(const MatrixX3d& points);

/// The rotation that brings `points` nearest to `onto` (row by row, both about their centroids, by
/// least squares); never a reflection. Source: Kabsch 1976. Precondition: equally many rows.
Eigen::Matrix3d best_rotation(const MatrixX3d& points, const MatrixX3d& onto);

/// Named directions to look from.
enum class View { kFront, kBack, kLeft, kRight, kTop, kBottom, kQuarter };

/// "front", "back", "left", "right" or "side" (right), "top", "bottom", "quarter" (from the front,
/// a little from the right and from above). kBadInput for another name.
Result<View> parse_view(std::string_view name);
std::string_view view_name(View view);

/// Camera axes that look at something standing as `frame` says.
Eigen::Matrix3d view_axes(const Frame& frame, View view);

/// The camera that shows all surfaces and rods of the scene as large as a picture of the given size
/// in pixels holds, less `margin` pixels on each side.
Camera fit_camera(
    const Scene& scene, const Eigen::Matrix3d& axes, int width, int height, int margin);

}  // namespace crosspatch
