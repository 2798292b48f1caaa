#include "tools/display_mesh.hpp"

#include <cmath>
#include <limits>

#include "core/index.hpp"
#include "transfer/assemble.hpp"
#include "transfer/carry_texture.hpp"

namespace crosspatch {
namespace {

/// Barycentric coordinates of `p`, which lies on `face`.
SurfacePoint locate(const TriangleMesh& mesh, int face, const Vector3d& p) {
  const Vector3d a = mesh.position(mesh.F(face, 0)), b = mesh.position(mesh.F(face, 1));
  const Vector3d c = mesh.position(mesh.F(face, 2));
  const Vector3d n = (b - a).cross(c - a);
  const double area = n.squaredNorm();
  SurfacePoint point{face, Vector3d::Constant(1.0 / 3)};
  if (!(area > 0)) return point;
  point.bary = Vector3d((c - b).cross(p - b).dot(n), (a - c).cross(p - c).dot(n), 0) / area;
  point.bary[2] = 1 - point.bary[0] - point.bary[1];
  point.bary = point.bary.cwiseMax(0.0);
  point.bary /= point.bary.sum();
  return point;
}

void locate_corners(const TriangleMesh& mesh, DisplayMesh& display) {
  const TexturedMesh& m = display.mesh;
  for (int t = 0; t < m.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k)
      display.corner.push_back(
          locate(mesh, m.target_face[idx(t)], m.positions.row(m.triangles(t, k)).transpose()));
}

}  // namespace

Result<DisplayMesh> display_source(const AttributedMesh& source,
                                   const std::vector<std::uint8_t>& patch) {
  auto own = carry_texture(source, source, identity_map(source.prepared.mesh));
  if (!own) return tl::unexpected(own.error());
  DisplayMesh display;
  display.mesh = std::move(own->mesh);
  locate_corners(source.prepared.mesh, display);
  for (const SurfacePoint& p : display.corner)
    display.place.push_back(position(source.prepared.mesh, p));
  for (const int f : display.mesh.target_face) display.patch.push_back(patch[idx(f)]);
  return display;
}

Result<DisplayMesh> display_target(const AttributedMesh& source,
                                   const AttributedMesh& target,
                                   const std::vector<std::uint8_t>& patch,
                                   const SurfaceMap& map,
                                   double tolerance) {
  // Places are carried as two more UV sets, in a scale at which the tolerance of UVs means ours;
  // the last coordinate holds the patch, at whose borders it jumps, as UVs do at seams.
  CarryTextureOptions options;
  const Eigen::RowVector3d low = source.soup.positions.colwise().minCoeff();
  const double size = (source.soup.positions.colwise().maxCoeff() - low).maxCoeff();
  const double scale = options.uv_tolerance_texels / options.default_texels / (tolerance * size);
  PolygonSoup soup = source.soup;
  const std::size_t first = soup.uv_sets.size();
  std::vector<Vector2d> xy, z;
  for (const int v : soup.corner_vertex) {
    const Vector3d p = (soup.positions.row(v) - low).transpose() * scale;
    xy.emplace_back(p[0], p[1]);
    z.emplace_back(p[2], kNoPatch);
  }
  const std::vector<int> polygon = polygon_of_corner(soup);
  for (int f = source.prepared.mesh.face_count() - 1; f >= 0; --f) {
    const int p = polygon[idx(source.prepared.numbering.soup_corner[idx(3 * f)])];
    for (int c = soup.polygon_begin[idx(p)]; c < soup.polygon_begin[idx(p) + 1]; ++c)
      z[idx(c)][1] = patch[idx(f)];
  }
  soup.uv_sets.push_back(std::move(xy));
  soup.uv_sets.push_back(std::move(z));
  auto carried = carry_texture({source.prepared, soup}, target, map, options);
  if (!carried) return tl::unexpected(carried.error());
  DisplayMesh display;
  display.mesh = std::move(carried->mesh);
  locate_corners(target.prepared.mesh, display);
  for (std::size_t c = 0; c < display.corner.size(); ++c) {
    const Vector2d &a = display.mesh.uv_sets[first][c], &b = display.mesh.uv_sets[first + 1][c];
    const bool mapped =
        display.mesh.materials[idx(display.mesh.material[c / 3])].name != kUnmappedMaterial;
    display.place.push_back(
        mapped ? Vector3d(Vector3d(a[0], a[1], b[0]) / scale + low.transpose())
               : Vector3d(Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())));
    if (c % 3 == 0)
      display.patch.push_back(mapped ? static_cast<std::uint8_t>(std::lround(b[1])) : kNoPatch);
  }
  display.mesh.uv_sets.resize(first);
  return display;
}

}  // namespace crosspatch
