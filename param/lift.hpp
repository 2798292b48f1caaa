#pragma once

#include <Eigen/LU>

#include "core/surface_point.hpp"

namespace crosspatch {

/// Carries points of the unit sphere to a surface in space.
class Lift {
 public:
  Lift() = default;
  Lift(const Lift&) = delete;
  Lift& operator=(const Lift&) = delete;
  virtual ~Lift() = default;

  /// Image of the unit vector x. `face` is a guess where to look, and on return the face that holds
  /// x.
  virtual Vector3d point(const Vector3d& x, int& face) const = 0;
  /// 3 x 3 derivative of point() at x, known to lie in `face`; only its action on vectors
  /// orthogonal to x counts.
  virtual Eigen::Matrix3d derivative(const Vector3d& x, int face) const = 0;
};

/// The sphere of area 1 about the origin.
class SphereLift final : public Lift {
 public:
  Vector3d point(const Vector3d& x, int& face) const override;
  Eigen::Matrix3d derivative(const Vector3d& x, int face) const override;
};

/// A closed mesh of genus 0 embedded in the unit sphere with great-circle edges, or a disc in the
/// plane z = 1: x goes to the point with the same central-projection barycentric coordinates in the
/// face that holds it (outside the disc: the face where the walk met the boundary, coordinates
/// clamped).
class MeshLift final : public Lift {
 public:
  /// `X` (#V x 3, unit rows) embeds `mesh`: every face is positively oriented. Both must outlive
  /// the lift; rows of X may change.
  MeshLift(const TriangleMesh& mesh, const MatrixX3d& X) : mesh_(&mesh), X_(&X) {}

  Vector3d point(const Vector3d& x, int& face) const override;
  Eigen::Matrix3d derivative(const Vector3d& x, int face) const override;

  /// The face that holds x, found by a visibility walk from `face` (any valid face).
  [[nodiscard]] int locate(const Vector3d& x, int face) const;
  /// x as a point of the mesh; `face` as in point().
  SurfacePoint surface_point(const Vector3d& x, int& face) const;

 private:
  [[nodiscard]] Vector3d barycentric(const Vector3d& x, int face) const;

  const TriangleMesh* mesh_;
  const MatrixX3d* X_;
};

}  // namespace crosspatch
