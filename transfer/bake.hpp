#pragma once

#include <array>

#include "param/surface_map.hpp"
#include "transfer/image_codec.hpp"
#include "transfer/source_attributes.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

/// Sides of images that can be baked.
constexpr int kLeastBakeSize = 16, kLargestBakeSize = 16384;

struct BakeOptions {
  int size = 2048;           ///< texels a side, kLeastBakeSize to kLargestBakeSize
  ImageEncoding encoding{};  ///< of the images made
  /// Share of the target's area that may be folded over in its own texture coordinates. Ours:
  /// well-made ones have up to 1e-4, those seen from one side, whose folds show as streaks, 4e-3
  /// and more.
  double most_folded = 1e-3;
};

/// Mip levels at which seams are looked at.
constexpr int kSeamLevels = 5;

/// CPU seconds of the whole process, stage by stage.
struct BakeSeconds {
  double prepare = 0;  ///< unwrap and overlay
  double decode = 0;   ///< images of the source
  double raster = 0;
  double gutter = 0;
  double measure = 0;  ///< texels counted, seams compared
  double encode = 0;   ///< images made
};

struct BakeStatistics {
  bool own_unwrap = false;    ///< the target's own texture coordinates were used
  std::string why_not_own{};  ///< if not
  int charts = 0;             ///< of the atlas, if one was made
  int overlay_triangles = 0;
  double coverage = 0;       ///< carried part of the target's area
  double texels_filled = 0;  ///< share of the texels inside islands that got a value
  double used = 0;           ///< share of the image inside islands
  /// Texels a unit of length, target over source, at the median and at 5 and 95 % of the area; 0
  /// where the source has no image.
  std::array<double, 3> density_ratio{0, 0, 0};
  /// Difference of the base colour on the two sides of seams, beyond the contrast that the source
  /// has there, in 255ths, at 95 % of their length, per mip level: see seam_error().
  std::array<double, kSeamLevels> seam_error{};
  BakeSeconds cpu_seconds{};
};

struct BakedTexture {
  TexturedMesh mesh;
  BakeStatistics statistics;
};

/// Paints the look of `source` into new images over `target`, whose triangles stay as they are.
///
/// The images lie over the target's own texture coordinates where these are an unwrap (own_unwrap)
/// without folds, else over an atlas (make_atlas). Every texel is filled through the exact map with
/// the mean of its footprint in the source's texture; gutters continue across seams with what lies
/// there, and smoothly elsewhere. Factors and vertex colours are painted in; base colour always,
/// other kinds where a material of the source has them. Normal maps are turned into the target's
/// tangent frames. Places that the map does not reach are grey. kBadInput: an image of the source
/// cannot be decoded; `size` is out of range. Cost: linear in texels and overlay triangles.
Result<BakedTexture> bake_texture(const AttributedMesh& source,
                                  const AttributedMesh& target,
                                  const SurfaceMap& map,
                                  const BakeOptions& options = {});

}  // namespace crosspatch
