#pragma once

#include <vector>

#include "core/types.hpp"
#include "tools/bitmap.hpp"

namespace crosspatch {

/// An image to be wrapped round a surface, with smaller copies of itself for distant views.
struct Texture {
  std::vector<Bitmap> levels;  ///< levels[0] is the image; each next one half as wide and high
  bool repeat_s = true;        ///< outside [0, 1]: repeat, else clamp
  bool repeat_t = true;
};

/// Builds the smaller copies, averaging in linear light.
Texture make_texture(Bitmap bitmap);

/// Triangles with a colour. The colour at a point is the product of what is given: the corner
/// colours, the face's texture at `corner_uv` (glTF convention, v downwards from the upper left),
/// and a solid checker at `corner_solid`.
///
/// Invariants: (1) F indexes V and corner arrays have 3 #F entries or none; (2) face_texture is
/// empty or has #F entries, each -1 or an index into Scene::textures, and then corner_uv is given.
struct Surface {
  MatrixX3d V;
  MatrixX3i F;
  MatrixX3d corner_normal;  ///< for smooth shading; none = flat
  std::vector<Color> corner_color;
  MatrixX2d corner_uv;
  std::vector<int> face_texture;
  MatrixX3d corner_solid;  ///< the checker's cells are unit cubes
};

/// A round-ended rod from a to b; a sphere where a == b. Lengths in the scene's units.
struct Rod {
  Vector3d a;
  Vector3d b;
  double radius = 0;
  Color color = Color::Zero();
};

struct Scene {
  std::vector<Surface> surfaces;
  std::vector<Texture> textures;
  std::vector<Rod> rods;
};

/// Parallel projection. Rows of `axes` are the picture's right, its up, and the direction towards
/// the viewer: an orthonormal, right-handed frame.
struct Camera {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Vector3d centre = Vector3d::Zero();  ///< seen in the middle of the picture
  double pixel_size = 1;               ///< in the scene's units
};

struct RasterOptions {
  int width = 600;
  int height = 450;
  int samples = 3;  ///< per pixel and direction: 3 gives 9 samples a pixel
  Color background = Color::Ones();
};

/// Draws the scene: nearest thing first by a depth buffer, lit from the upper left behind the
/// viewer, inner sides of surfaces darker. Ties in depth go to the earlier thing.
Bitmap draw(const Scene& scene, const Camera& camera, const RasterOptions& options);

}  // namespace crosspatch
