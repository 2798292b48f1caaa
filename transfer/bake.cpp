#include "transfer/bake.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <optional>
#include <set>

#include "core/index.hpp"
#include "transfer/assemble.hpp"
#include "transfer/atlas.hpp"
#include "transfer/bake_canvas.hpp"
#include "transfer/carried.hpp"
#include "transfer/seam_error.hpp"
#include "transfer/source_look.hpp"
#include "transfer/tangents.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

// Texels this far outside of a triangle still count as inside: rounding must leave no gap between
// two triangles.
constexpr double kMargin = 1e-4;

/// Adds the CPU seconds of its life to a sum.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), begun_(std::clock()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { sum_ += static_cast<double>(std::clock() - begun_) / CLOCKS_PER_SEC; }

 private:
  double& sum_;
  std::clock_t begun_;
};

/// The target as it will be written: its own triangles over the unwrap, in one material.
TexturedMesh plain_target(const AttributedMesh& target,
                          const SurfaceMap& map,
                          const Unwrap& unwrap) {
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
  plain.map_point = map.point_of_target_vertex;
  return plain;
}

/// Calls paint(triangle, rows) for all triangles, in bands of rows side by side, from left to right
/// in each, so that neighbours in the image follow each other and find the texels of both images
/// still in the cache. Where two claim a texel the later one has it, whatever the number of
/// threads.
template <class Paint>
void for_each_in_bands(const Carried& carried, int size, Paint paint) {
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
  const auto left = [&](int t) {
    const auto& c = carried.texels[idx(t)];
    return std::min({c[0][0], c[1][0], c[2][0]});
  };
  tbb::parallel_for(0, bands, [&](int b) {
    std::vector<std::pair<float, int>> order;
    order.reserve(of_band[idx(b)].size());
    for (const int t : of_band[idx(b)]) order.emplace_back(static_cast<float>(left(t)), t);
    std::sort(order.begin(), order.end());
    for (const auto& [x, t] : order)
      paint(t, std::array<int, 2>{b * kRows, std::min(size, (b + 1) * kRows)});
  });
}

/// Faces that are too small for any texel's centre give their value to the texel they lie in.
void paint_small_faces(BakeCanvas& canvas,
                       const Carried& carried,
                       const SourceLook& look,
                       const std::vector<std::uint8_t>& has_texels) {
  for (int t = 0; t < carried.mesh.triangle_count(); ++t) {
    if (has_texels[idx(carried.mesh.target_face[idx(t)])] != 0) continue;
    const auto& c = carried.texels[idx(t)];
    const Vector2d centre = (c[0] + c[1] + c[2]) / 3;
    const int x = std::clamp(static_cast<int>(centre[0]), 0, canvas.size - 1);
    const int y = std::clamp(static_cast<int>(centre[1]), 0, canvas.size - 1);
    const std::size_t texel = canvas.texel(x, y);
    if (canvas.state[texel] != kEmpty) continue;
    const TexelSpan middle{y, x, x, Vector3d::Constant(1.0 / 3), Vector3d::Zero()};
    look.paint(look.triangle(t, c), middle, &canvas.values[idx(canvas.channels) * texel]);
    canvas.state[texel] = kFilled;
  }
}

BakeCanvas paint(const Carried& carried, const SourceLook& look, int faces, int size) {
  BakeCanvas canvas = make_canvas(size, look.channels());
  std::vector<std::uint8_t> has_texels(idx(faces), 0);
  for_each_in_bands(carried, size, [&](int t, std::array<int, 2> rows) {
    std::optional<SourceLook::Triangle> triangle;
    for_each_span(carried.texels[idx(t)], kMargin, rows, size, [&](const TexelSpan& span) {
      if (!triangle) {
        triangle = look.triangle(t, carried.texels[idx(t)]);
        // Bands share faces.
        std::atomic_ref(has_texels[idx(carried.mesh.target_face[idx(t)])])
            .store(1, std::memory_order_relaxed);
      }
      const std::size_t texel = canvas.texel(span.left, span.y);
      look.paint(*triangle, span, &canvas.values[idx(canvas.channels) * texel]);
      std::fill_n(canvas.state.begin() + static_cast<std::ptrdiff_t>(texel),
                  span.right - span.left + 1,
                  kFilled);
    });
  });
  paint_small_faces(canvas, carried, look, has_texels);
  return canvas;
}

/// Share of the texels inside of the target's faces that are painted, and of all that are inside.
void count_texels(const BakeCanvas& canvas, const Unwrap& unwrap, BakeStatistics& s) {
  long inside = 0, filled = 0;
  for (int f = 0; f < static_cast<int>(unwrap.uv.size()) / 3; ++f)
    for_each_span(in_texels(unwrap, f, canvas.size),
                  0,
                  {0, canvas.size},
                  canvas.size,
                  [&](const TexelSpan& span) {
                    const auto first =
                        canvas.state.begin() + static_cast<std::ptrdiff_t>(canvas.texel(0, span.y));
                    inside += span.right - span.left + 1;
                    filled += std::count(first + span.left, first + span.right + 1, kFilled);
                  });
  s.texels_filled = inside > 0 ? static_cast<double>(filled) / static_cast<double>(inside) : 1;
  s.used = static_cast<double>(inside) / static_cast<double>(canvas.state.size());
}

/// The painted values as an image, without the one more. It takes their room: a second image would
/// be the most that a bake ever holds.
RasterImage as_image(BakeCanvas canvas) {
  canvas.values.pop_back();
  return {canvas.size, canvas.size, canvas.channels, std::move(canvas.values)};
}

/// Normals of the canvas, of unit length again.
RasterImage finish_normals(BakeCanvas canvas) {
  RasterImage image = as_image(std::move(canvas));
  for (auto p = image.values.begin(); p != image.values.end(); p += 3) {
    Vector3d n = Vector3d(p[0], p[1], p[2]) / 65535 * 2 - Vector3d::Ones();
    n = n.norm() > 1e-6 ? Vector3d(n.normalized()) : Vector3d(Vector3d::UnitZ());
    // The value 128 of 255 stands for zero, so that a flat map reads back flat.
    for (int k = 0; k < 3; ++k)
      p[k] = static_cast<std::uint16_t>(
          std::lround(std::clamp((n[k] * 127.5 + 127.5) * 257, 0.0, 65535.0)));
  }
  return image;
}

/// The painted canvas as an image: stored values, colour not multiplied by alpha.
RasterImage finish(BakeCanvas canvas, bool color) {
  RasterImage image = as_image(std::move(canvas));
  const std::uint16_t* srgb = srgb_values();
  if (image.channels == 3) {
    if (color)
      for (std::uint16_t& v : image.values) v = srgb[v];
    return image;
  }
  for (auto p = image.values.begin(); p != image.values.end(); p += 4)
    for (int k = 0; k < 3; ++k) {
      std::uint32_t plain = p[k];
      if (p[3] != 0) plain = std::min<std::uint32_t>(65535, (plain * 65535U + p[3] / 2U) / p[3]);
      p[k] = color ? srgb[plain] : static_cast<std::uint16_t>(plain);
    }
  return image;
}

bool is_color(Channel channel) {
  return channel == Channel::kBaseColor || channel == Channel::kEmissive;
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
  BakeSeconds& seconds = statistics.cpu_seconds;
  {
    const Stopwatch watch(seconds.decode);
    Result<SourceLook> made = SourceLook::make(carried.mesh, channel);
    if (!made) return tl::unexpected(made.error());
    look = std::move(*made);
  }
  std::optional<Stopwatch> watch(std::in_place, seconds.raster);
  if (channel == Channel::kNormal) look->set_target_tangents(tangents_at_corners(target, carried));
  BakeCanvas canvas = paint(carried, *look, surface.face_count(), carried.size);
  look.reset();
  watch.emplace(seconds.measure);
  if (channel == Channel::kBaseColor) count_texels(canvas, unwrap, statistics);
  watch.emplace(seconds.gutter);
  // What lies across a seam has another tangent frame: gutters of normals are grown smoothly.
  if (channel != Channel::kNormal)
    continue_across_seams(canvas, surface, unwrap, AtlasOptions{.size = carried.size}.padding());
  push_pull(canvas);
  if (channel == Channel::kNormal) return finish_normals(std::move(canvas));
  return finish(std::move(canvas), is_color(channel));
}

/// The target's own texture coordinates, if images can be baked over them.
Result<Unwrap> serving_unwrap(const AttributedMesh& target, double most_folded) {
  Result<Unwrap> own = own_unwrap(target);
  if (!own) return own;
  if (const double folded = folded_share(target.prepared.mesh, *own); folded > most_folded)
    return fail(ErrorCode::kBadInput,
                fmt::format("{:.2g} of its area is folded over in the image", folded));
  return own;
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
  std::optional<Stopwatch> watch(std::in_place, s.cpu_seconds.prepare);
  Unwrap unwrap;
  if (Result<Unwrap> own = serving_unwrap(target, options.most_folded)) {
    s.own_unwrap = true;
    unwrap = std::move(*own);
  } else {
    s.why_not_own = own.error().message;
    Result<Atlas> atlas = make_atlas(surface, {.size = size});
    if (!atlas) return tl::unexpected(atlas.error());
    s.charts = atlas->charts;
    unwrap = std::move(atlas->unwrap);
  }
  const Carried carried = carry(source, target, map, unwrap, size, s);
  result.mesh = plain_target(target, map, unwrap);
  const std::set<int> used(carried.mesh.material.begin(), carried.mesh.material.end());
  Material material = baked_material(carried.mesh, used);
  constexpr int kClamp = 33071;
  watch.reset();
  for (const Channel channel : kChannels) {
    if (!is_needed(carried.mesh, used, channel)) continue;
    const Result<RasterImage> image =
        bake_channel(carried, result.mesh, surface, unwrap, channel, s);
    if (!image) return tl::unexpected(image.error());
    watch.emplace(s.cpu_seconds.measure);
    if (channel == Channel::kBaseColor) s.seam_error = seam_error(*image, surface, unwrap);
    watch.emplace(s.cpu_seconds.encode);
    ImageEncoding encoding = options.encoding;
    encoding.is_color = is_color(channel);
    Result<std::vector<unsigned char>> bytes = encode_image_file(*image, encoding);
    if (!bytes) return tl::unexpected(bytes.error());
    watch.reset();
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
