#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "core/soup.hpp"
#include "core/types.hpp"
#include "transfer/motion.hpp"

namespace crosspatch {

/// A triangle mesh ready for export, with attributes at triangle corners.
///
/// Corner 3 t + k belongs to triangle t. UVs follow glTF's convention: (0, 0) is the image's upper
/// left corner, v grows downwards.
///
/// Invariants: (1) triangles index rows of `positions`; (2) material and target_face have one entry
/// a triangle, `normals`, `colors` (unless empty) and every UV set one a corner; (3) every position
/// and UV is finite, every normal has length 1 or is zero; (4) material indexes `materials`,
/// textures index `images` and `uv_sets`, or have image -1; (5) `motion` is valid for the
/// positions, bind frames are translations, and a vertex follows at most four joints with weights
/// whose sum is 1 in single precision, whatever the order.
struct TexturedMesh {
  MatrixX3d positions;
  MatrixX3i triangles;
  std::vector<int> material;
  std::vector<int> target_face;  ///< face of the prepared target mesh that holds the triangle
  std::vector<Vector3d> normals;
  std::vector<std::vector<Vector2d>> uv_sets;
  std::vector<std::array<float, 4>> colors;  ///< linear RGBA
  std::vector<Material> materials;
  std::vector<ImageFile> images;
  Eigen::Matrix4d node_transform = Eigen::Matrix4d::Identity();
  std::vector<int> map_point;  ///< empty, or per position its point of the map, -1 if it has none
  Motion motion;               ///< of the positions; frames of the skeleton are not turned

  [[nodiscard]] int triangle_count() const { return static_cast<int>(triangles.rows()); }
};

/// Checks every invariant of TexturedMesh.
Status validate(const TexturedMesh& mesh);

}  // namespace crosspatch
