#include "param/shape.hpp"

#include <fmt/format.h>

#include <tuple>
#include <utility>

#include "core/curvature.hpp"
#include "param/sphere_refinement.hpp"

namespace crosspatch {
namespace {

using Levels = std::pair<ProgressiveMesh, MeshLevel>;

Result<Levels> make_levels(const TriangleMesh& mesh,
                           const std::vector<int>& landmarks,
                           const ShapeOptions& options) {
  auto progressive = make_progressive_mesh(
      mesh, {.shape_vertices = options.coarse_vertices, .protected_vertices = landmarks});
  if (!progressive) return tl::unexpected(progressive.error());
  auto coarse = mesh_level(mesh, *progressive, options.coarse_vertices);
  if (!coarse) return tl::unexpected(coarse.error());
  return Levels(std::move(*progressive), std::move(*coarse));
}

}  // namespace

Result<Shape> make_shape(TriangleMesh mesh,
                         const std::vector<int>& landmarks,
                         const ShapeOptions& options) {
  if (const int chi = euler_characteristic(mesh); chi != 2)
    return fail(
        ErrorCode::kNoCorrespondence,
        fmt::format("surface: Euler characteristic {} (genus {}), only spheres (2) can be mapped",
                    chi,
                    genus(mesh)));
  auto levels = make_levels(mesh, landmarks, options);
  if (!levels) return tl::unexpected(levels.error());
  auto& [progressive, coarse] = *levels;
  auto X = embed_in_sphere(mesh, progressive);
  if (!X) return tl::unexpected(X.error());
  auto curvature = curvature_fields(mesh);
  if (!curvature) return tl::unexpected(curvature.error());
  return Shape{std::move(mesh),
               std::move(progressive),
               std::move(coarse),
               std::move(*X),
               std::move(*curvature),
               {},
               {},
               {}};
}

Result<Shape> with_coarse_level(const Shape& shape,
                                const std::vector<int>& landmarks,
                                const ShapeOptions& options) {
  return make_levels(shape.mesh, landmarks, options).map([&](Levels levels) {
    Shape other = shape;
    std::tie(other.progressive, other.coarse) = std::move(levels);
    return other;
  });
}

}  // namespace crosspatch
