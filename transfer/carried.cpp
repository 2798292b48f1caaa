#include "transfer/carried.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "transfer/assemble.hpp"
#include "transfer/overlay_mesh.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

Carried lay_over(const AttributedMesh& source,
                 const AttributedMesh& target,
                 const SourceAttributes& attributes,
                 const OverlayMesh& overlay,
                 const Unwrap& unwrap,
                 int size) {
  Carried carried;
  carried.size = size;
  carried.mesh = assemble(source, target, attributes, overlay);
  carried.texels.reserve(overlay.triangles.size());
  carried.target_bary.reserve(3 * overlay.triangles.size());
  for (const OverlayMesh::Triangle& triangle : overlay.triangles) {
    const std::array<Vector2d, 3> face = in_texels(unwrap, triangle.target_face, size);
    std::array<Vector2d, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const SurfacePoint& p = overlay.points[idx(overlay.wedge_point[idx(triangle.wedge[k])])];
      const Vector3d bary = in_face(target.prepared.mesh, p, triangle.target_face).bary;
      corner[k] = bary[0] * face[0] + bary[1] * face[1] + bary[2] * face[2];
      carried.target_bary.push_back(bary);
    }
    carried.texels.push_back(corner);
  }
  return carried;
}

/// Texels per length of the new image over those of the source's base colour image.
std::array<double, 3> density_ratio(const Carried& carried,
                                    const SourceAttributes& attributes,
                                    const std::vector<double>& surface_ratio,
                                    const OverlayMesh& overlay) {
  std::vector<std::pair<double, double>> ratios;  // and the area they hold for
  double total = 0;
  for (int t = 0; t < carried.mesh.triangle_count(); ++t) {
    const Material& m = carried.mesh.materials[idx(carried.mesh.material[idx(t)])];
    const auto& triangle = overlay.triangles[idx(t)];
    if (!triangle.mapped || m.base_color.image < 0) continue;
    const int set = m.base_color.uv_set;
    const Vector2d& scale =
        attributes.texels[idx((triangle.material + 1) * attributes.uv_sets + set)];
    std::array<Vector2d, 3> uv;
    for (std::size_t k = 0; k < 3; ++k)
      uv[k] = carried.mesh.uv_sets[idx(set)][idx(3 * t) + k].cwiseProduct(scale);
    const auto& c = carried.texels[idx(t)];
    const double there = std::abs(doubled_area(uv[0], uv[1], uv[2]));
    const double here = std::abs(doubled_area(c[0], c[1], c[2]));
    const double area = surface_ratio[idx(t)];
    if (!(there > 0) || !(here > 0)) continue;
    ratios.emplace_back(std::sqrt(here / there), area);
    total += area;
  }
  std::sort(ratios.begin(), ratios.end());
  std::array<double, 3> result{0, 0, 0};
  const std::array<double, 3> shares{0.5, 0.05, 0.95};
  for (std::size_t i = 0; i < 3; ++i) {
    double sum = 0;
    for (const auto& [ratio, area] : ratios) {
      sum += area;
      result[i] = ratio;
      if (sum >= shares[i] * total) break;
    }
  }
  return result;
}

/// Areas of the carried triangles on the target.
std::vector<double> areas(const TexturedMesh& mesh) {
  std::vector<double> area;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Vector3d a = mesh.positions.row(mesh.triangles(t, 0)).transpose();
    const Vector3d b = mesh.positions.row(mesh.triangles(t, 1)).transpose();
    const Vector3d c = mesh.positions.row(mesh.triangles(t, 2)).transpose();
    area.push_back((b - a).cross(c - a).norm() / 2);
  }
  return area;
}

double coverage(const OverlayMesh& overlay, const std::vector<double>& area) {
  double mapped = 0, total = 0;
  for (std::size_t t = 0; t < area.size(); ++t) {
    total += area[t];
    if (overlay.triangles[t].mapped) mapped += area[t];
  }
  return total > 0 ? mapped / total : 0;
}

}  // namespace

Carried carry(const AttributedMesh& source,
              const AttributedMesh& target,
              const SurfaceMap& map,
              const Unwrap& unwrap,
              int size,
              BakeStatistics& s) {
  const SourceAttributes attributes = source_attributes(source, size);
  OverlayMesh overlay =
      make_overlay_mesh(attributes, source.prepared.mesh, target.prepared.mesh, map);
  Carried carried = lay_over(source, target, attributes, overlay, unwrap, size);
  s.overlay_triangles = carried.mesh.triangle_count();
  const std::vector<double> area = areas(carried.mesh);
  s.coverage = coverage(overlay, area);
  s.density_ratio = density_ratio(carried, attributes, area, overlay);
  const std::vector<Material>& materials = source.soup.materials;
  if (std::none_of(materials.begin(), materials.end(), [](const Material& m) {
        return m.normal.image >= 0;
      })) {  // frames are not needed, and as large as an image
    carried.target_bary = {};
    carried.mesh.normals = {};
    carried.mesh.positions = {};
    carried.mesh.map_point = {};
  }
  // Images come next, and no piece of the heap that the overlay lay in would serve them.
  overlay = {};
  malloc_trim(0);
  return carried;
}

}  // namespace crosspatch
