#include "transfer/source_attributes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image_header.hpp"
#include "core/index.hpp"

namespace crosspatch {
namespace {

std::array<const TextureRef*, 5> textures(const Material& m) {
  return {&m.base_color, &m.metallic_roughness, &m.normal, &m.occlusion, &m.emissive};
}

/// A texture transform scales UVs before it turns them; under a turn either axis may meet either
/// side of the image, so the larger product is taken.
Vector2d texels_per_unit(const PolygonSoup& soup, const TextureRef& t) {
  const auto size = sniff_image(soup.images[idx(t.image)].bytes);
  if (!size) return Vector2d::Zero();
  Vector2d texels(size->width, size->height);
  if (!t.transform) return texels;
  if (t.transform->rotation_radians == 0)
    texels = texels.cwiseProduct(t.transform->scale.cwiseAbs());
  else
    texels.setConstant(texels.maxCoeff() * t.transform->scale.cwiseAbs().maxCoeff());
  return texels;
}

std::vector<Vector2d> texel_table(const PolygonSoup& soup, int uv_sets, int default_texels) {
  const int materials = static_cast<int>(soup.materials.size());
  std::vector<Vector2d> table(idx((materials + 1) * uv_sets), Vector2d::Zero());
  for (int m = 0; m < materials; ++m)
    for (const TextureRef* t : textures(soup.materials[idx(m)]))
      if (t->image >= 0 && t->uv_set < uv_sets) {
        Vector2d& entry = table[idx((m + 1) * uv_sets + t->uv_set)];
        entry = entry.cwiseMax(texels_per_unit(soup, *t));
      }
  for (Vector2d& entry : table)
    if (entry.isZero(0)) entry.setConstant(default_texels);
  return table;
}

bool needs_uv(const PolygonSoup& soup, int material, int set) {
  if (material < 0) return false;
  const auto used = textures(soup.materials[idx(material)]);
  return std::any_of(used.begin(), used.end(), [&](const TextureRef* t) {
    return t->image >= 0 && t->uv_set == set;
  });
}

void gather_corners(const AttributedMesh& source, SourceAttributes& a) {
  const PolygonSoup& soup = source.soup;
  const int faces = source.prepared.mesh.face_count();
  const std::vector<int> polygon = polygon_of_corner(soup);
  a.values.assign(idx(3 * faces * a.width), 0.0);
  a.material.assign(idx(faces), -1);
  a.usable.assign(idx(faces), true);
  for (int f = 0; f < faces; ++f) {
    const int first = source.prepared.numbering.soup_corner[idx(3 * f)];
    if (!soup.polygon_material.empty())
      a.material[idx(f)] = soup.polygon_material[idx(polygon[idx(first)])];
    for (int k = 0; k < 3; ++k) {
      const int corner = source.prepared.numbering.soup_corner[idx(3 * f + k)];
      double* out = &a.values[idx((3 * f + k) * a.width)];
      for (int s = 0; s < a.uv_sets; ++s) {
        const Vector2d uv = soup.uv_sets[idx(s)][idx(corner)];
        if (uv.allFinite()) {
          out[idx(2 * s)] = uv[0];
          out[idx(2 * s + 1)] = uv[1];
        } else if (needs_uv(soup, a.material[idx(f)], s)) {
          a.usable[idx(f)] = false;
        }
      }
      if (a.colors)
        for (int c = 0; c < 4; ++c)
          out[idx(2 * a.uv_sets + c)] = double(soup.corner_colors[idx(corner)][idx(c)]);
    }
  }
}

bool agree(const SourceAttributes& a, int corner, int other) {
  // Finer than the spacing of single-precision UVs in [0.5, 1), so that only equal UVs agree.
  constexpr double kEqual = 1e-8;
  for (int i = 0; i < a.width; ++i)
    if (std::abs(a.values[idx(corner * a.width + i)] - a.values[idx(other * a.width + i)]) > kEqual)
      return false;
  return true;
}

}  // namespace

SourceAttributes source_attributes(const AttributedMesh& source, int default_texels) {
  SourceAttributes a;
  a.uv_sets = static_cast<int>(source.soup.uv_sets.size());
  a.colors = !source.soup.corner_colors.empty();
  a.width = 2 * a.uv_sets + (a.colors ? 4 : 0);
  a.texels = texel_table(source.soup, a.uv_sets, default_texels);
  gather_corners(source, a);
  const TriangleMesh& mesh = source.prepared.mesh;
  a.continuous.assign(idx(mesh.halfedge_count()), false);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const int twin = mesh.twin[idx(h)];
    if (twin < 0) continue;
    const int f = face_of(h), g = face_of(twin);
    a.continuous[idx(h)] = a.material[idx(f)] == a.material[idx(g)] && a.usable[idx(f)] &&
                           a.usable[idx(g)] && agree(a, h, next(twin)) && agree(a, next(h), twin);
  }
  return a;
}

void evaluate(const SourceAttributes& a, const SurfacePoint& p, double* out) {
  const double* corner = a.values.data() + idx(3 * p.face * a.width);
  for (int i = 0; i < a.width; ++i)
    out[i] = p.bary[0] * corner[i] + p.bary[1] * corner[idx(a.width + i)] +
             p.bary[2] * corner[idx(2 * a.width + i)];
}

AttributeError difference(const SourceAttributes& attributes,
                          int material,
                          const double* a,
                          const double* b) {
  AttributeError error;
  for (int s = 0; s < attributes.uv_sets; ++s) {
    const Vector2d& texels = attributes.texels[idx((material + 1) * attributes.uv_sets + s)];
    const std::size_t u = idx(2 * s), v = u + 1;
    const Vector2d d(a[u] - b[u], a[v] - b[v]);
    error.uv_texels = std::max(error.uv_texels, d.cwiseProduct(texels).norm());
  }
  for (int i = 2 * attributes.uv_sets; i < attributes.width; ++i)
    error.color = std::max(error.color, std::abs(a[i] - b[i]));
  return error;
}

}  // namespace crosspatch
