#pragma once

#include <Eigen/LU>

#include "core/surface_point.hpp"

namespace crosspatch {

/// Carries points of the unit sphere to a surface in space.
class Lift {
 public:
  static constexpr int kMostFields = 8;

  /// Coordinates t of the directions at a point: it moves by on_sphere t, its image by on_surface
  /// t.
  struct Frame {
    Eigen::Matrix<double, 3, 2> on_sphere, on_surface;  ///< the latter orthonormal
  };

  Lift() = default;
  Lift(const Lift&) = delete;
  Lift& operator=(const Lift&) = delete;
  virtual ~Lift() = default;

  /// Image of the unit vector x. `face` is a guess where to look, and on return the face that holds
  /// x.
  virtual Vector3d point(const Vector3d& x, int& face) const = 0;
  /// The frame at x, known to lie in `face`.
  virtual Frame frame(const Vector3d& x, int face) const = 0;
  /// Where x gets when its image goes straight ahead on the surface, along the tangent vector d and
  /// by its length. `face` as in point().
  virtual Vector3d walk(const Vector3d& x, int& face, const Vector3d& d) const = 0;

  /// Values of fields on the surface at the image of x, known to lie in `face`, and their
  /// derivatives along the frame's coordinates (fields x 2). None unless a lift carries some.
  using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostFields, 1>;
  using Rates = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, kMostFields, 2>;
  virtual Values values(const Vector3d& /*x*/, int /*face*/) const { return {}; }
  virtual Rates rates(int /*face*/) const { return {}; }
};

/// The sphere of area 1 about the origin.
class SphereLift final : public Lift {
 public:
  Vector3d point(const Vector3d& x, int& face) const override;
  Frame frame(const Vector3d& x, int face) const override;
  Vector3d walk(const Vector3d& x, int& face, const Vector3d& d) const override;
};

/// A closed mesh of genus 0 embedded in the unit sphere with great-circle edges, or a disc in the
/// plane z = 1: x goes to the point with the same central-projection barycentric coordinates in the
/// face that holds it (outside the disc: the face where the walk met the boundary, coordinates
/// clamped).
class MeshLift final : public Lift {
 public:
  /// `X` (#V x 3, unit rows) embeds `mesh`: every face is positively oriented. Both must outlive
  /// the lift; rows of X may change.
  /// `fields` (#V x at most kMostFields), if given, are carried along, linear on each face.
  MeshLift(const TriangleMesh& mesh, const MatrixX3d& X, const Eigen::MatrixXd* fields = nullptr)
      : mesh_(&mesh), X_(&X), fields_(fields) {}

  Vector3d point(const Vector3d& x, int& face) const override;
  Frame frame(const Vector3d& x, int face) const override;
  /// Crosses edges as if their two faces were unfolded into one plane; ends at boundaries.
  Vector3d walk(const Vector3d& x, int& face, const Vector3d& d) const override;
  Values values(const Vector3d& x, int face) const override;
  Rates rates(int face) const override;

  /// The face that holds x, found by a visibility walk from `face` (any valid face).
  [[nodiscard]] int locate(const Vector3d& x, int face) const;
  /// x as a point of the mesh; `face` as in point().
  SurfacePoint surface_point(const Vector3d& x, int& face) const;

 private:
  [[nodiscard]] Vector3d barycentric(const Vector3d& x, int face) const;
  /// Orthonormal axes of the face's plane.
  [[nodiscard]] Eigen::Matrix<double, 3, 2> plane(int face) const;
  [[nodiscard]] Eigen::Matrix3d derivative(const Vector3d& x, int face) const;

  const TriangleMesh* mesh_;
  const MatrixX3d* X_;
  const Eigen::MatrixXd* fields_;
};

}  // namespace crosspatch
