#include "transfer/carry_texture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "transfer/assemble.hpp"
#include "transfer/overlay_mesh.hpp"

namespace crosspatch {
namespace {

Status check(const AttributedMesh& source,
             const AttributedMesh& target,
             const SurfaceMap& map,
             const CarryTextureOptions& options) {
  if (!(options.uv_tolerance_texels >= 0))
    return fail(ErrorCode::kBadInput,
                fmt::format("UV tolerance {} is negative", options.uv_tolerance_texels));
  if (!(options.color_tolerance >= 0))
    return fail(ErrorCode::kBadInput,
                fmt::format("colour tolerance {} is negative", options.color_tolerance));
  if (options.default_texels < 1)
    return fail(ErrorCode::kBadInput,
                fmt::format("default image size {} is below 1", options.default_texels));
  const auto in_range = [](const std::vector<int>& faces, int count) {
    return std::all_of(faces.begin(), faces.end(), [&](int f) { return f >= 0 && f < count; });
  };
  if (!in_range(map.source_face, source.prepared.mesh.face_count()) ||
      !in_range(map.target_face, target.prepared.mesh.face_count()))
    return fail(ErrorCode::kInternal, "texture transfer: the map names faces the meshes lack");
  return {};
}

void count(const OverlayMesh& overlay, const TriangleMesh& target, CarryTextureStatistics& s) {
  const Eigen::VectorXd areas = face_areas(target);
  std::vector<double> lost(idx(target.face_count()), 0.0);
  for (const OverlayMesh::Triangle& t : overlay.triangles) {
    for (const std::uint8_t side : t.side) s.seam_cuts += (side & kSeam) != 0 ? 1 : 0;
    if (t.mapped) continue;
    const Vector3d a = position(target, overlay.points[idx(overlay.wedge_point[idx(t.wedge[0])])]);
    const Vector3d b = position(target, overlay.points[idx(overlay.wedge_point[idx(t.wedge[1])])]);
    const Vector3d c = position(target, overlay.points[idx(overlay.wedge_point[idx(t.wedge[2])])]);
    lost[idx(t.target_face)] += (b - a).cross(c - a).norm() / 2;
  }
  double missing = 0;
  for (const double area : lost) missing += area;
  const double total = areas.sum();
  s.coverage = total > 0 ? 1 - missing / total : 0;
  s.triangles = static_cast<int>(overlay.triangles.size());
  s.unmapped_faces = overlay.unmapped_faces;
  s.degenerate_polygons = overlay.degenerate_polygons;
}

}  // namespace

Result<CarriedTexture> carry_texture(const AttributedMesh& source,
                                     const AttributedMesh& target,
                                     const SurfaceMap& map,
                                     const CarryTextureOptions& options) {
  if (Status s = check(source, target, map, options); !s) return tl::unexpected(s.error());
  const TriangleMesh& surface = target.prepared.mesh;
  const SourceAttributes attributes = source_attributes(source, options.default_texels);
  OverlayMesh overlay = make_overlay_mesh(attributes, source.prepared.mesh, surface, map);
  CarriedTexture result;
  result.statistics.target_triangles = surface.face_count();
  result.statistics.overlay_triangles = static_cast<int>(overlay.triangles.size());
  const AttributeError worst = thin_out(overlay,
                                        attributes,
                                        surface,
                                        {.uv_tolerance_texels = options.uv_tolerance_texels,
                                         .color_tolerance = options.color_tolerance});
  result.statistics.max_uv_error_texels = worst.uv_texels;
  result.statistics.max_color_error = worst.color;
  count(overlay, surface, result.statistics);
  result.mesh = assemble(source, target, attributes, overlay);
  return result;
}

}  // namespace crosspatch
