#pragma once

#include <array>
#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// Signed double area of the triangle of three barycentric points, relative to that of the face
/// they are given in; positive counter-clockwise. Exactly zero where all three lie on one edge of
/// the face, that is where one weight is exactly zero in all of them.
double signed_area(const Vector3d& a, const Vector3d& b, const Vector3d& c);

/// Cuts a simple polygon into triangles by ear clipping, the best shaped ear first.
///
/// `polygon`: counter-clockwise corners, barycentric in one face; `frame`: that face laid flat, for
/// judging shape. Corners on a straight line are allowed. Returns #corners - 2 triangles of indices
/// into `polygon`, each of positive area (beyond rounding), or none at all if that cannot be had.
/// Cost: cubic in the number of corners.
std::vector<std::array<int, 3>> triangulate(const std::vector<Vector3d>& polygon,
                                            const std::array<Vector2d, 3>& frame);

/// Triangle (a, b, c) laid flat without distortion, counter-clockwise, first corner at the origin.
std::array<Vector2d, 3> lay_flat(const Vector3d& a, const Vector3d& b, const Vector3d& c);

}  // namespace crosspatch
