#pragma once

#include <optional>
#include <vector>

#include "core/result.hpp"
#include "core/soup.hpp"
#include "tools/raster.hpp"

namespace crosspatch {

/// A surface of the given triangles without a colour, shaded smoothly by area-weighted normals.
Surface make_surface(const MatrixX3d& V, const MatrixX3i& F);

/// The file's fan triangles over its vertices, without a colour.
Surface plain_surface(const PolygonSoup& soup);

/// The file's mesh as it is meant to look: base colours, base colour textures and corner colours.
/// kBadInput when a texture that is used cannot be decoded, with the image's name.
Result<Scene> textured_scene(const PolygonSoup& soup);

/// Colours of the vertices (#V), blended inside faces; or of whole faces (#F).
void color_vertices(Surface& surface, const std::vector<Color>& colors);
void color_faces(Surface& surface, const std::vector<Color>& colors);

/// Values from `low` to `high`; values outside are shown as the nearer end.
struct ValueRange {
  double low = 0;
  double high = 1;
};

/// Scalar field on the vertices in field colours; without a range that of the finite values.
void color_field(Surface& surface,
                 const Eigen::VectorXd& values,
                 const std::optional<ValueRange>& range = {});
/// Values of the faces, such as distortion, in heat colours.
void color_heat(Surface& surface, const Eigen::VectorXd& face_values, const ValueRange& range);
/// One clearly different colour a label; labels below 0 stay grey.
void color_patches(Surface& surface, const std::vector<int>& face_label);

/// Spheres at the points (#points x 3).
void add_points(Scene& scene, const MatrixX3d& points, double radius, const Color& color);
/// A tube along the points, in their order.
void add_curve(Scene& scene,
               const std::vector<Vector3d>& points,
               double radius,
               const Color& color);

/// Length of the diagonal of the box around the rows of V; 0 for none.
double diagonal(const MatrixX3d& V);

}  // namespace crosspatch
