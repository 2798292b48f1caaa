#include "transfer/round_trip.hpp"

#include <algorithm>

#include "core/image_header.hpp"
#include "core/index.hpp"
#include "transfer/overlay_mesh.hpp"
#include "transfer/texel_raster.hpp"
#include "transfer/unwrap.hpp"

namespace crosspatch {
namespace {

constexpr int kMostTexels = 1024;  // ours: one more second at most, and finer differs little

/// Leaves nothing to the materials but their base colour.
void keep_base_color(std::vector<Material>& materials) {
  for (Material& m : materials)
    m.metallic_roughness = m.normal = m.occlusion = m.emissive = TextureRef{};
}

/// A baked mesh as if it had been read from a file of the mesh's own numbering.
struct AsRead {
  PreparedMesh prepared;
  PolygonSoup soup;
};

AsRead as_read(const TriangleMesh& mesh, const TexturedMesh& baked) {
  AsRead read;
  read.prepared.mesh = mesh;
  read.soup.positions = mesh.V;
  FileNumbering& numbering = read.prepared.numbering;
  for (int v = 0; v < mesh.vertex_count(); ++v) numbering.mesh_vertex.push_back(v);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    read.soup.corner_vertex.push_back(mesh.from(h));
    numbering.soup_corner.push_back(h);
    numbering.triangle_corners.push_back(h);
  }
  for (int f = 0; f < mesh.face_count(); ++f) {
    read.soup.polygon_begin.push_back(3 * (f + 1));
    numbering.file_triangle.push_back(f);
  }
  read.soup.uv_sets = baked.uv_sets;
  read.soup.polygon_material = baked.material;
  read.soup.materials = baked.materials;
  read.soup.images = baked.images;
  keep_base_color(read.soup.materials);
  return read;
}

/// Faces of the source all of which has a counterpart in faces of the target that have one.
std::vector<bool> returning_faces(const TriangleMesh& source,
                                  const TriangleMesh& target,
                                  const SurfaceMap& map) {
  std::vector<bool> returning = filled_faces(source, inverse(map));
  const std::vector<bool> there = filled_faces(target, map);
  for (int p = 0; p < map.polygon_count(); ++p)
    if (!there[idx(map.target_face[idx(p)])]) returning[idx(map.source_face[idx(p)])] = false;
  return returning;
}

/// The larger side of the base colour images, at most kMostTexels; that without an image.
int comparable_size(const PolygonSoup& soup) {
  int size = 0;
  for (const Material& m : soup.materials)
    if (m.base_color.image >= 0)
      if (const auto header = sniff_image(soup.images[idx(m.base_color.image)].bytes))
        size = std::max({size, header->width, header->height});
  return size > 0 ? std::clamp(size, kLeastBakeSize, kMostTexels) : kMostTexels;
}

Result<RasterImage> base_color(const Result<BakedTexture>& baked) {
  if (!baked) return tl::unexpected(baked.error());
  return decode_image_file(
      baked->mesh.images[idx(baked->mesh.materials[0].base_color.image)].bytes);
}

}  // namespace

Result<RoundTrip> round_trip(const AttributedMesh& source,
                             const AttributedMesh& target,
                             const SurfaceMap& map,
                             const TexturedMesh& baked) {
  const Result<Unwrap> unwrap = own_unwrap(source);
  if (!unwrap) return tl::unexpected(unwrap.error());
  const TriangleMesh& mesh = source.prepared.mesh;
  PolygonSoup look = source.soup;
  keep_base_color(look.materials);
  const AttributedMesh plain{source.prepared, look};
  const AsRead there = as_read(target.prepared.mesh, baked);
  RoundTrip trip;
  trip.size = comparable_size(look);
  const BakeOptions options{.size = trip.size,
                            .encoding = {.bits = 16, .png_compression = 1},
                            .most_folded = 1};  // what the source has there is folded too
  const Result<RasterImage> before =
      base_color(bake_texture(plain, plain, identity_map(mesh), options));
  if (!before) return tl::unexpected(before.error());
  const Result<RasterImage> after =
      base_color(bake_texture({there.prepared, there.soup}, plain, inverse(map), options));
  if (!after) return tl::unexpected(after.error());

  std::vector<std::uint8_t> covered(idx(trip.size) * idx(trip.size), 0);
  const std::vector<bool> returning = returning_faces(mesh, target.prepared.mesh, map);
  const Eigen::VectorXd area = face_areas(mesh);
  double area_there = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!returning[idx(f)]) continue;
    area_there += area[f];
    for_each_texel(
        in_texels(*unwrap, f, trip.size),
        0,
        {0, trip.size},
        trip.size,
        [&](int x, int y, const Vector3d&) { covered[idx(y) * idx(trip.size) + idx(x)] = 1; });
  }
  trip.covered = std::min(1.0, area_there / area.sum());  // sums round
  trip.similarity = image_similarity(*before, *after, covered);
  return trip;
}

}  // namespace crosspatch
