#pragma once

#include <Eigen/Core>
#include <vector>

#include "transfer/textured_mesh.hpp"

namespace crosspatch {

/// Tangents of the triangles of `material` for the UV set `uv_set`, per corner of the mesh, (x, y,
/// z, w); zero at corners of other materials. The unit vector (x, y, z) points along increasing u
/// in the plane of the corner's normal; w = 1 or -1 tells the side of the bitangent, w
/// cross(normal, tangent), which points along decreasing v, upwards in the image. Corners that
/// share place, normal, UV and w share their tangent: the mean over them, weighted by angle, as in
/// MikkTSpace (Mikkelsen 2008), on which normal maps are commonly baked.
std::vector<Eigen::Vector4d> corner_tangents(const TexturedMesh& mesh, int material, int uv_set);

/// The normal of corner `corner` of triangle t, or the triangle's own where it has none.
Vector3d shading_normal(const TexturedMesh& mesh, int t, int corner);

}  // namespace crosspatch
