#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "core/types.hpp"

namespace crosspatch {

/// An image file kept as it was: encoded bytes, never decoded here.
struct ImageFile {
  std::string name;       ///< file name without folder, or the glTF image's name
  std::string mime_type;  ///< "image/png" or "image/jpeg", "" if neither
  std::vector<unsigned char> bytes;
};

/// KHR_texture_transform: uv' = T(offset) R(rotation) S(scale) uv.
struct TextureTransform {
  Vector2d offset{0, 0};
  double rotation_radians = 0;
  Vector2d scale{1, 1};
};

/// The coordinates at which an image is read; unchanged without a transform. Turns
/// counter-clockwise in a picture whose v runs downwards.
Vector2d transformed(const Vector2d& uv, const std::optional<TextureTransform>& transform);

/// The use of an image by a material. Wrap and filter numbers are those of glTF samplers (10497
/// repeat, 33071 clamp, ...).
struct TextureRef {
  int image = -1;  ///< into PolygonSoup::images; -1 = none
  int uv_set = 0;
  int wrap_s = 10497;
  int wrap_t = 10497;
  int min_filter = -1;  ///< -1 = unset
  int mag_filter = -1;
  double strength = 1;  ///< normal scale or occlusion strength
  std::optional<TextureTransform> transform;
};

/// glTF 2.0 metallic-roughness material; OBJ materials are expressed in it.
struct Material {
  std::string name;
  std::array<double, 4> base_color_factor{1, 1, 1, 1};
  double metallic_factor = 0;
  double roughness_factor = 1;
  std::array<double, 3> emissive_factor{0, 0, 0};
  std::string alpha_mode = "OPAQUE";
  double alpha_cutoff = 0.5;
  bool double_sided = false;
  TextureRef base_color, metallic_roughness, normal, occlusion, emissive;
};

/// What a mesh file says, in its own numbering, before anything is believed of it.
///
/// Polygon p has the corners polygon_begin[p] .. polygon_begin[p + 1] - 1; attributes of corners
/// are indexed by corner. Fan triangles are numbered through the file: polygon p with n corners
/// gives n - 2 (none if n < 3), each made of the polygon's first corner and two consecutive ones.
/// UV convention: that of glTF, (0, 0) is the image's upper left corner and v grows downwards;
/// OBJ's v is turned on reading.
struct PolygonSoup {
  MatrixX3d positions;  ///< #vertices of the file x 3
  std::vector<int> polygon_begin{0};
  std::vector<int> corner_vertex;
  std::vector<std::vector<Vector2d>>
      uv_sets;                           ///< each one entry a corner; NaN where a corner has none
  std::vector<Vector3d> corner_normals;  ///< empty, or one a corner
  std::vector<std::array<float, 4>> corner_colors;  ///< empty, or linear RGBA, one a corner
  std::vector<int> polygon_material;                ///< empty, or one a polygon; -1 = none
  std::vector<Material> materials;
  std::vector<ImageFile> images;
  Eigen::Matrix4d node_transform =
      Eigen::Matrix4d::Identity();  ///< glTF node, not applied to positions
  bool skinned = false;   ///< glTF: a skeleton moves the mesh; see transfer's read_gltf_motion
  int morph_targets = 0;  ///< ditto, the most that a part of the mesh has
  int animations = 0;     ///< ditto
  std::vector<std::string> notes;  ///< what the reader had to pass over, one line each

  [[nodiscard]] int polygon_count() const { return static_cast<int>(polygon_begin.size()) - 1; }
  [[nodiscard]] int corner_count() const { return static_cast<int>(corner_vertex.size()); }
};

/// Checks that positions are finite, that corners, materials and images are in range, and that
/// every attribute has one entry a corner (or a polygon). kBadInput names the first that is not.
Status validate(const PolygonSoup& soup);

/// Per corner: the polygon that it belongs to.
std::vector<int> polygon_of_corner(const PolygonSoup& soup);

/// The corners of all fan triangles, three each, in the numbering described at PolygonSoup.
std::vector<int> fan_triangle_corners(const PolygonSoup& soup);

}  // namespace crosspatch
