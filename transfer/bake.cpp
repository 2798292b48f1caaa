#include "transfer/bake.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/index.hpp"
#include "transfer/assemble.hpp"
#include "transfer/atlas.hpp"
#include "transfer/bake_canvas.hpp"
#include "transfer/overlay_mesh.hpp"
#include "transfer/seam_error.hpp"
#include "transfer/source_look.hpp"
#include "transfer/tangents.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

// Texels this far outside of a triangle still count as inside: rounding must leave no gap between
// two triangles.
constexpr double kMargin = 1e-4;

/// The overlay, with the places of its triangles in the image.
struct Carried {
  int size = 0;  ///< of the image, texels a side
  TexturedMesh mesh;
  std::vector<std::array<Vector2d, 3>> texels;  ///< per triangle
  std::vector<Vector3d> target_bary;            ///< per corner, in its target face
};

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

/// The target as it will be written: its own triangles over the unwrap, in one material.
TexturedMesh plain_target(const AttributedMesh& target, const Unwrap& unwrap) {
  const TriangleMesh& mesh = target.prepared.mesh;
  TexturedMesh plain;
  plain.positions = mesh.V;
  plain.triangles = mesh.F;
  plain.normals = corner_normals(target);
  plain.uv_sets = {unwrap.uv};
  plain.material.assign(idx(mesh.face_count()), 0);
  plain.target_face.resize(idx(mesh.face_count()));
  for (int f = 0; f < mesh.face_count(); ++f) plain.target_face[idx(f)] = f;
  plain.node_transform = target.soup.node_transform;
  return plain;
}

/// Calls paint(triangle, x, y, bary) for the texels of all triangles, in bands of rows side by
/// side: where two claim a texel the later one has it, whatever the number of threads.
template <class Paint>
void for_each_carried_texel(const Carried& carried, int size, Paint paint) {
  constexpr int kRows = 32;
  const int bands = (size + kRows - 1) / kRows;
  std::vector<std::vector<int>> of_band(idx(bands));
  for (std::size_t t = 0; t < carried.texels.size(); ++t) {
    const auto& c = carried.texels[t];
    const auto [low, high] = std::minmax({c[0][1], c[1][1], c[2][1]});
    const int first = std::clamp(static_cast<int>(low - 1) / kRows, 0, bands - 1);
    const int last = std::clamp(static_cast<int>(high + 1) / kRows, 0, bands - 1);
    for (int b = first; b <= last; ++b) of_band[idx(b)].push_back(static_cast<int>(t));
  }
  tbb::parallel_for(0, bands, [&](int b) {
    for (const int t : of_band[idx(b)])
      paint(t, std::array<int, 2>{b * kRows, std::min(size, (b + 1) * kRows)});
  });
}

void put(BakeCanvas& canvas, int x, int y, const Eigen::Array4f& value) {
  const std::size_t texel = canvas.texel(x, y);
  for (int k = 0; k < 4; ++k)
    canvas.rgba[4 * texel + idx(k)] =
        static_cast<std::uint16_t>(std::clamp(value[k], 0.0F, 1.0F) * 65535 + 0.5F);
  canvas.state[texel] = kFilled;
}

Vector3d clamped(const Vector3d& bary) {
  const Vector3d inside = bary.cwiseMax(0.0);
  return inside / inside.sum();
}

/// Faces that are too small for any texel's centre give their value to the texel they lie in.
void paint_small_faces(BakeCanvas& canvas,
                       const Carried& carried,
                       const SourceLook& look,
                       const Unwrap& unwrap) {
  std::vector<bool> small(unwrap.uv.size() / 3);
  for (int f = 0; f < static_cast<int>(small.size()); ++f) {
    small[idx(f)] = true;
    for_each_texel(in_texels(unwrap, f, canvas.size),
                   kMargin,
                   {0, canvas.size},
                   canvas.size,
                   [&](int, int, const Vector3d&) { small[idx(f)] = false; });
  }
  for (int t = 0; t < carried.mesh.triangle_count(); ++t) {
    if (!small[idx(carried.mesh.target_face[idx(t)])]) continue;
    const auto& c = carried.texels[idx(t)];
    const Vector2d centre = (c[0] + c[1] + c[2]) / 3;
    const int x = std::clamp(static_cast<int>(centre[0]), 0, canvas.size - 1);
    const int y = std::clamp(static_cast<int>(centre[1]), 0, canvas.size - 1);
    if (canvas.state[canvas.texel(x, y)] == kEmpty)
      put(canvas, x, y, look.at(look.triangle(t, c), Vector3d::Constant(1.0 / 3)));
  }
}

BakeCanvas paint(const Carried& carried, const SourceLook& look, const Unwrap& unwrap, int size) {
  BakeCanvas canvas = make_canvas(size);
  for_each_carried_texel(carried, size, [&](int t, std::array<int, 2> rows) {
    const SourceLook::Triangle triangle = look.triangle(t, carried.texels[idx(t)]);
    for_each_texel(
        carried.texels[idx(t)], kMargin, rows, size, [&](int x, int y, const Vector3d& b) {
          put(canvas, x, y, look.at(triangle, clamped(b)));
        });
  });
  paint_small_faces(canvas, carried, look, unwrap);
  return canvas;
}

/// Share of the texels inside of the target's faces that are painted, and of all that are inside.
void count_texels(const BakeCanvas& canvas, const Unwrap& unwrap, BakeStatistics& s) {
  long inside = 0, filled = 0;
  for (int f = 0; f < static_cast<int>(unwrap.uv.size()) / 3; ++f)
    for_each_texel(in_texels(unwrap, f, canvas.size),
                   0,
                   {0, canvas.size},
                   canvas.size,
                   [&](int x, int y, const Vector3d&) {
                     ++inside;
                     filled += canvas.state[canvas.texel(x, y)] == kFilled ? 1 : 0;
                   });
  s.texels_filled = inside > 0 ? static_cast<double>(filled) / static_cast<double>(inside) : 1;
  s.used = static_cast<double>(inside) / static_cast<double>(canvas.state.size());
}

/// The painted canvas as an image: stored values, colour not multiplied by alpha.
RasterImage finish(const BakeCanvas& canvas, Channel channel, bool has_alpha) {
  const bool color = channel == Channel::kBaseColor || channel == Channel::kEmissive;
  const ColorSpace space = color ? ColorSpace::kSrgb : ColorSpace::kLinear;
  RasterImage image{canvas.size, canvas.size, has_alpha ? 4 : 3, {}};
  image.values.reserve(canvas.state.size() * idx(image.channels));
  for (std::size_t texel = 0; texel < canvas.state.size(); ++texel) {
    const std::uint16_t* p = &canvas.rgba[4 * texel];
    if (channel == Channel::kNormal) {
      Vector3d n = Vector3d(p[0], p[1], p[2]) / 65535 * 2 - Vector3d::Ones();
      n = n.norm() > 1e-6 ? Vector3d(n.normalized()) : Vector3d(Vector3d::UnitZ());
      // The value 128 of 255 stands for zero, so that a flat map reads back flat.
      for (int k = 0; k < 3; ++k)
        image.values.push_back(static_cast<std::uint16_t>(
            std::lround(std::clamp((n[k] * 127.5 + 127.5) * 257, 0.0, 65535.0))));
      continue;
    }
    const std::uint32_t alpha = has_alpha ? p[3] : 65535;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t plain =
          alpha == 0 ? p[k] : std::min<std::uint32_t>(65535, (p[k] * 65535U + alpha / 2) / alpha);
      image.values.push_back(to_stored(static_cast<std::uint16_t>(plain), space));
    }
    if (has_alpha) image.values.push_back(static_cast<std::uint16_t>(alpha));
  }
  return image;
}

const char* name(Channel channel) {
  switch (channel) {
    case Channel::kBaseColor:
      return "base_color";
    case Channel::kMetallicRoughness:
      return "metallic_roughness";
    case Channel::kNormal:
      return "normal";
    case Channel::kOcclusion:
      return "occlusion";
    case Channel::kEmissive:
      break;
  }
  return "emissive";
}

TextureRef& texture_of(Material& material, Channel channel) {
  return const_cast<TextureRef&>(texture_of(std::as_const(material), channel));
}

/// Whether the materials in use cannot do without an image of this kind.
bool is_needed(const TexturedMesh& mesh, const std::set<int>& used, Channel channel) {
  if (channel == Channel::kBaseColor) return true;
  const Material& first = mesh.materials[idx(*used.begin())];
  return std::any_of(used.begin(), used.end(), [&](int i) {
    const Material& m = mesh.materials[idx(i)];
    if (texture_of(m, channel).image >= 0) return true;
    if (channel == Channel::kMetallicRoughness)
      return m.metallic_factor != first.metallic_factor ||
             m.roughness_factor != first.roughness_factor;
    return channel == Channel::kEmissive && m.emissive_factor != first.emissive_factor;
  });
}

/// The material of the baked mesh: what is not painted comes from the first material in use, and
/// from whichever is less opaque.
Material baked_material(const TexturedMesh& mesh, const std::set<int>& used) {
  Material baked = mesh.materials[idx(*used.begin())];
  baked.name = "baked";
  baked.base_color_factor = {1, 1, 1, 1};
  for (const Channel channel : kChannels) texture_of(baked, channel) = {};
  for (const int i : used) {
    const Material& m = mesh.materials[idx(i)];
    baked.double_sided = baked.double_sided || m.double_sided;
    if (m.alpha_mode == "BLEND" || (m.alpha_mode == "MASK" && baked.alpha_mode == "OPAQUE")) {
      baked.alpha_mode = m.alpha_mode;
      baked.alpha_cutoff = m.alpha_cutoff;
    }
  }
  return baked;
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

std::vector<Eigen::Vector4d> tangents_at_corners(const TexturedMesh& target,
                                                 const Carried& carried) {
  const std::vector<Eigen::Vector4d> of_face = corner_tangents(target, 0, 0);
  std::vector<Eigen::Vector4d> tangents;
  tangents.reserve(carried.target_bary.size());
  for (std::size_t c = 0; c < carried.target_bary.size(); ++c) {
    const std::size_t f = 3 * idx(carried.mesh.target_face[c / 3]);
    const Vector3d& b = carried.target_bary[c];
    tangents.emplace_back(b[0] * of_face[f] + b[1] * of_face[f + 1] + b[2] * of_face[f + 2]);
  }
  return tangents;
}

/// One image over the target; of the base colour, texels are counted. Everything that is as large
/// as an image is gone when it returns, but the image.
Result<RasterImage> bake_channel(const Carried& carried,
                                 const TexturedMesh& target,
                                 const TriangleMesh& surface,
                                 const Unwrap& unwrap,
                                 Channel channel,
                                 BakeStatistics& statistics) {
  std::optional<SourceLook> look;
  if (Result<SourceLook> made = SourceLook::make(carried.mesh, channel); made)
    look = std::move(*made);
  else
    return tl::unexpected(made.error());
  if (channel == Channel::kNormal) look->set_target_tangents(tangents_at_corners(target, carried));
  BakeCanvas canvas = paint(carried, *look, unwrap, carried.size);
  const bool has_alpha = channel == Channel::kBaseColor && look->has_alpha();
  look.reset();
  if (channel == Channel::kBaseColor) count_texels(canvas, unwrap, statistics);
  // What lies across a seam has another tangent frame: gutters of normals are grown smoothly.
  if (channel != Channel::kNormal)
    continue_across_seams(canvas, surface, unwrap, AtlasOptions{.size = carried.size}.padding());
  push_pull(canvas);
  return finish(canvas, channel, has_alpha);
}

}  // namespace

Result<BakedTexture> bake_texture(const AttributedMesh& source,
                                  const AttributedMesh& target,
                                  const SurfaceMap& map,
                                  const BakeOptions& options) {
  const int size = options.size;
  if (size < kLeastBakeSize || size > kLargestBakeSize)
    return fail(
        ErrorCode::kBadInput,
        fmt::format("image size {} is outside [{}, {}]", size, kLeastBakeSize, kLargestBakeSize));
  BakedTexture result;
  BakeStatistics& s = result.statistics;
  const TriangleMesh& surface = target.prepared.mesh;
  Unwrap unwrap;
  if (Result<Unwrap> own = own_unwrap(target)) {
    s.own_unwrap = true;
    unwrap = std::move(*own);
  } else {
    s.why_not_own = own.error().message;
    Result<Atlas> atlas = make_atlas(surface, {.size = size});
    if (!atlas) return tl::unexpected(atlas.error());
    s.charts = atlas->charts;
    unwrap = std::move(atlas->unwrap);
  }
  const SourceAttributes attributes = source_attributes(source, size);
  const OverlayMesh overlay = make_overlay_mesh(attributes, source.prepared.mesh, surface, map);
  const Carried carried = lay_over(source, target, attributes, overlay, unwrap, size);
  s.overlay_triangles = carried.mesh.triangle_count();
  const std::vector<double> area = areas(carried.mesh);
  s.coverage = coverage(overlay, area);
  s.density_ratio = density_ratio(carried, attributes, area, overlay);

  result.mesh = plain_target(target, unwrap);
  const std::set<int> used(carried.mesh.material.begin(), carried.mesh.material.end());
  Material material = baked_material(carried.mesh, used);
  constexpr int kClamp = 33071;
  for (const Channel channel : kChannels) {
    if (!is_needed(carried.mesh, used, channel)) continue;
    const Result<RasterImage> image =
        bake_channel(carried, result.mesh, surface, unwrap, channel, s);
    if (!image) return tl::unexpected(image.error());
    if (channel == Channel::kBaseColor) s.seam_error = seam_error(*image, surface, unwrap);
    ImageEncoding encoding = options.encoding;
    encoding.is_color = channel == Channel::kBaseColor || channel == Channel::kEmissive;
    Result<std::vector<unsigned char>> bytes = encode_image_file(*image, encoding);
    if (!bytes) return tl::unexpected(bytes.error());
    TextureRef& ref = texture_of(material, channel);
    ref.image = static_cast<int>(result.mesh.images.size());
    ref.wrap_s = ref.wrap_t = kClamp;
    result.mesh.images.push_back(image_file(name(channel), encoding.format, std::move(*bytes)));
  }
  if (material.metallic_roughness.image >= 0)
    material.metallic_factor = material.roughness_factor = 1;
  if (material.emissive.image >= 0) material.emissive_factor = {1, 1, 1};
  result.mesh.materials = {material};
  return result;
}

}  // namespace crosspatch
