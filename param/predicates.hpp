#pragma once

#include "core/types.hpp"

namespace crosspatch {

/// Which side of the directed line a -> b the point c lies on: +1 left (a, b, c counter-clockwise),
/// -1 right, 0 on the line. The sign is that of the real determinant of the doubles as given: exact
/// for all finite inputs, including those whose products would overflow or underflow.
///
/// A floating-point filter decides nearly all calls (Shewchuk 1997, stage A); the rest is done in
/// integers of as many bits as needed.
int orient2d(const Vector2d& a, const Vector2d& b, const Vector2d& c);

/// Which side of the plane through the origin, a and b the point c lies on: the exact sign of
/// det [a b c]. For points of the sphere: +1 if c is left of the great circle from a to b seen from
/// outside. Exact for all finite inputs.
int orient_sphere(const Vector3d& a, const Vector3d& b, const Vector3d& c);

}  // namespace crosspatch
