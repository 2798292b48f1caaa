#pragma once

#include "param/surface_map.hpp"
#include "transfer/source_attributes.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

struct CarryTextureOptions {
  /// How far the carried UVs may stray from the exact map, in texels of the material's largest
  /// image. Half a texel is what nearest-texel lookup cannot tell from exact.
  double uv_tolerance_texels = 0.5;
  /// The same for vertex colours; half a step of 8-bit colour.
  double color_tolerance = 0.5 / 255;
  /// Image size assumed for UV sets without an image. Ours: a common texture size.
  int default_texels = 1024;
};

struct CarryTextureStatistics {
  int target_triangles = 0;        ///< of the target before cutting
  int overlay_triangles = 0;       ///< of the full common subdivision
  int triangles = 0;               ///< written
  int seam_cuts = 0;               ///< sides of output triangles along carried seams
  double max_uv_error_texels = 0;  ///< against the exact map, at the overlay's points and sides
  double max_color_error = 0;      ///< ditto
  double coverage = 0;             ///< carried part of the target's area
  int unmapped_faces = 0;          ///< target faces that the map does not fill
  int degenerate_polygons = 0;     ///< overlay polygons without measurable area
};

struct CarriedTexture {
  TexturedMesh mesh;
  CarryTextureStatistics statistics;
};

/// Carries UV sets, materials, images and vertex colours of `source` to the surface of `target`
/// without resampling an image: the target's triangles are cut along the source's seams and
/// material borders and wherever the linear UVs would stray too far from the map, nothing else.
///
/// The surface does not move: every new vertex lies on a face of the target, neighbours are cut at
/// the same points, and original vertices stay. No output triangle touches two sides of a seam.
/// Normals are those of the target's file if it has any, else area-weighted. Target faces that the
/// map does not fill, and places whose source lacks the UVs its textures need, get the plain
/// material "unmapped". kBadInput when an option is out of range; kInternal when the map does not
/// belong to the two meshes.
Result<CarriedTexture> carry_texture(const AttributedMesh& source,
                                     const AttributedMesh& target,
                                     const SurfaceMap& map,
                                     const CarryTextureOptions& options = {});

}  // namespace crosspatch
