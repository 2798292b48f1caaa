#include "tools/scene_surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/weld.hpp"
#include "tools/image_io.hpp"
#include "tools/palette.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(Eigen::Index i) {
  return static_cast<size_t>(i);
}

constexpr int kClampToEdge = 33071;  // glTF sampler's wrap mode

/// Decodes each base colour image that a material uses; -1 for materials without one.
Result<std::vector<int>> add_textures(const PolygonSoup& soup, Scene& scene) {
  std::vector<int> texture_of_material;
  for (const Material& material : soup.materials) {
    const TextureRef& use = material.base_color;
    texture_of_material.push_back(-1);
    if (use.image < 0 || at(use.image) >= soup.images.size() ||
        at(use.uv_set) >= soup.uv_sets.size())
      continue;
    const ImageFile& image = soup.images[at(use.image)];
    Result<Bitmap> bitmap = decode_image(image.bytes);
    if (!bitmap)
      return fail(bitmap.error().code, "'" + image.name + "': " + bitmap.error().message);
    Texture texture = make_texture(std::move(*bitmap));
    texture.repeat_s = use.wrap_s != kClampToEdge;
    texture.repeat_t = use.wrap_t != kClampToEdge;
    texture_of_material.back() = static_cast<int>(scene.textures.size());
    scene.textures.push_back(std::move(texture));
  }
  return texture_of_material;
}

Color material_color(const Material& material) {
  return Eigen::Vector3d(material.base_color_factor[0],
                         material.base_color_factor[1],
                         material.base_color_factor[2])
      .cast<float>();
}

/// The polygon that each fan triangle comes from.
std::vector<int> fan_polygons(const PolygonSoup& soup) {
  std::vector<int> polygon;
  for (int p = 0; p < soup.polygon_count(); ++p)
    for (int k = soup.polygon_begin[at(p)] + 2; k < soup.polygon_begin[at(p + 1)]; ++k)
      polygon.push_back(p);
  return polygon;
}

}  // namespace

Surface make_surface(const MatrixX3d& V, const MatrixX3i& F) {
  // Files repeat vertices along seams, where the surface is as smooth as elsewhere.
  const std::vector<int> place =
      weld(V, std::vector<bool>(at(static_cast<int>(V.rows())), true), 0);
  MatrixX3d normal = MatrixX3d::Zero(V.rows(), 3);
  for (int f = 0; f < F.rows(); ++f) {
    const Vector3d a = V.row(F(f, 0)), b = V.row(F(f, 1)), c = V.row(F(f, 2));
    const Eigen::RowVector3d n = (b - a).cross(c - a).transpose();
    for (int k = 0; k < 3; ++k) normal.row(place[at(F(f, k))]) += n;
  }
  normal.rowwise().normalize();
  Surface surface;
  surface.V = V;
  surface.F = F;
  surface.corner_normal.resize(3 * F.rows(), 3);
  for (int f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      surface.corner_normal.row(3 * f + k) = normal.row(place[at(F(f, k))]);
  return surface;
}

Surface plain_surface(const PolygonSoup& soup) {
  const std::vector<int> corners = fan_triangle_corners(soup);
  MatrixX3i F(static_cast<Eigen::Index>(corners.size() / 3), 3);
  for (size_t c = 0; c < corners.size(); ++c)
    F(static_cast<Eigen::Index>(c / 3), static_cast<Eigen::Index>(c % 3)) =
        soup.corner_vertex[at(corners[c])];
  Surface surface = make_surface(soup.positions, F);
  if (soup.corner_normals.empty()) return surface;
  for (size_t c = 0; c < corners.size(); ++c) {
    const Vector3d n = soup.corner_normals[at(corners[c])];
    if (n.allFinite() && n.norm() > 0)
      surface.corner_normal.row(static_cast<Eigen::Index>(c)) = n.normalized().transpose();
  }
  return surface;
}

Result<Scene> textured_scene(const PolygonSoup& soup) {
  Scene scene;
  const Result<std::vector<int>> textures = add_textures(soup, scene);
  if (!textures) return tl::unexpected(textures.error());
  const std::vector<int> fans = fan_triangle_corners(soup);
  const std::vector<int> polygon = fan_polygons(soup);
  Surface surface = plain_surface(soup);
  const MatrixX3i& F = surface.F;
  surface.corner_color.assign(at(3 * F.rows()), neutral_color());
  surface.face_texture.assign(at(F.rows()), -1);
  surface.corner_uv = MatrixX2d::Zero(3 * F.rows(), 2);
  for (int f = 0; f < F.rows(); ++f) {
    const int m = soup.polygon_material.empty() ? -1 : soup.polygon_material[at(polygon[at(f)])];
    const Material* material = m < 0 ? nullptr : &soup.materials[at(m)];
    const int texture = m < 0 ? -1 : (*textures)[at(m)];
    surface.face_texture[at(f)] = texture;
    for (int k = 0; k < 3; ++k) {
      const size_t corner = at(fans[at(3 * f + k)]), mine = at(3 * f + k);
      Color& color = surface.corner_color[mine];
      if (material != nullptr) color = material_color(*material);
      if (!soup.corner_colors.empty()) {
        const auto& c = soup.corner_colors[corner];
        const Color own(c[0], c[1], c[2]);
        color = material != nullptr ? Color(color.cwiseProduct(own)) : own;
      }
      if (texture >= 0) {
        const TextureRef& use = material->base_color;
        surface.corner_uv.row(3 * f + k) =
            transformed(soup.uv_sets[at(use.uv_set)][corner], use.transform).transpose();
      }
    }
  }
  scene.surfaces.push_back(std::move(surface));
  return scene;
}

void color_vertices(Surface& surface, const std::vector<Color>& colors) {
  assert(colors.size() == at(surface.V.rows()));
  surface.corner_color.resize(at(3 * surface.F.rows()));
  for (int f = 0; f < surface.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) surface.corner_color[at(3 * f + k)] = colors[at(surface.F(f, k))];
}

void color_faces(Surface& surface, const std::vector<Color>& colors) {
  assert(colors.size() == at(surface.F.rows()));
  surface.corner_color.resize(at(3 * surface.F.rows()));
  for (int f = 0; f < surface.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) surface.corner_color[at(3 * f + k)] = colors[at(f)];
}

void color_field(Surface& surface,
                 const Eigen::VectorXd& values,
                 const std::optional<ValueRange>& range) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values)
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  if (range) {
    low = range->low;
    high = range->high;
  }
  std::vector<Color> colors;
  colors.reserve(at(values.size()));
  for (const double value : values)
    colors.push_back(field_color(high > low ? (value - low) / (high - low) : 0));
  color_vertices(surface, colors);
}

void color_heat(Surface& surface, const Eigen::VectorXd& face_values, const ValueRange& range) {
  std::vector<Color> colors;
  colors.reserve(at(face_values.size()));
  for (const double value : face_values)
    colors.push_back(heat_color((value - range.low) / (range.high - range.low)));
  color_faces(surface, colors);
}

void color_patches(Surface& surface, const std::vector<int>& face_label) {
  std::vector<Color> colors;
  colors.reserve(face_label.size());
  for (const int label : face_label)
    colors.push_back(label < 0 ? neutral_color() : category_color(label));
  color_faces(surface, colors);
}

void add_points(Scene& scene, const MatrixX3d& points, double radius, const Color& color) {
  for (const auto& row : points.rowwise())
    scene.rods.push_back({row.transpose(), row.transpose(), radius, color});
}

void add_curve(Scene& scene,
               const std::vector<Vector3d>& points,
               double radius,
               const Color& color) {
  for (size_t i = 1; i < points.size(); ++i)
    scene.rods.push_back({points[i - 1], points[i], radius, color});
}

double diagonal(const MatrixX3d& V) {
  return V.rows() == 0 ? 0 : (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm();
}

}  // namespace crosspatch
