#include "core/soup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace crosspatch {
namespace {

Status check_polygons(const PolygonSoup& soup) {
  if (soup.polygon_begin.empty() || soup.polygon_begin.front() != 0 ||
      soup.polygon_begin.back() != soup.corner_count())
    return fail(ErrorCode::kBadInput, "polygons do not span the corners");
  for (int p = 0; p < soup.polygon_count(); ++p) {
    const auto begin = soup.polygon_begin.begin() + p;
    if (begin[1] < begin[0])
      return fail(ErrorCode::kBadInput, fmt::format("polygon {}: ends before it begins", p));
    for (int c = begin[0]; c < begin[1]; ++c) {
      const int v = soup.corner_vertex[static_cast<std::size_t>(c)];
      if (v < 0 || v >= soup.positions.rows())
        return fail(ErrorCode::kBadInput,
                    fmt::format("polygon {}: vertex {} (counted from 0) is outside [0, {})",
                                p,
                                v,
                                soup.positions.rows()));
    }
  }
  return {};
}

Status check_attributes(const PolygonSoup& soup) {
  const std::size_t corners = soup.corner_vertex.size();
  for (const auto& set : soup.uv_sets)
    if (set.size() != corners)
      return fail(ErrorCode::kBadInput,
                  fmt::format("{} texture coordinates for {} corners", set.size(), corners));
  if (!soup.corner_normals.empty() && soup.corner_normals.size() != corners)
    return fail(ErrorCode::kBadInput, "normals do not match the corners");
  if (!soup.corner_colors.empty() && soup.corner_colors.size() != corners)
    return fail(ErrorCode::kBadInput, "colours do not match the corners");
  if (!soup.polygon_material.empty() &&
      soup.polygon_material.size() != static_cast<std::size_t>(soup.polygon_count()))
    return fail(ErrorCode::kBadInput, "materials do not match the polygons");
  for (const int m : soup.polygon_material)
    if (m < -1 || m >= static_cast<int>(soup.materials.size()))
      return fail(ErrorCode::kBadInput,
                  fmt::format("material {} is outside [0, {})", m, soup.materials.size()));
  for (const Material& m : soup.materials)
    for (const TextureRef* t :
         {&m.base_color, &m.metallic_roughness, &m.normal, &m.occlusion, &m.emissive})
      if (t->image < -1 || t->image >= static_cast<int>(soup.images.size()) || t->uv_set < 0)
        return fail(ErrorCode::kBadInput,
                    fmt::format("material '{}': image {} is outside [0, {})",
                                m.name,
                                t->image,
                                soup.images.size()));
  return {};
}

}  // namespace

Status validate(const PolygonSoup& soup) {
  for (Eigen::Index v = 0; v < soup.positions.rows(); ++v)
    if (!soup.positions.row(v).allFinite())
      return fail(ErrorCode::kBadInput,
                  fmt::format("vertex {} (counted from 0): a coordinate is not finite", v));
  if (Status s = check_polygons(soup); !s) return s;
  return check_attributes(soup);
}

std::vector<int> polygon_of_corner(const PolygonSoup& soup) {
  std::vector<int> polygon;
  polygon.reserve(soup.corner_vertex.size());
  for (int p = 0; p < soup.polygon_count(); ++p) {
    const auto begin = soup.polygon_begin.begin() + p;
    polygon.insert(polygon.end(), static_cast<std::size_t>(begin[1] - begin[0]), p);
  }
  return polygon;
}

std::vector<int> fan_triangle_corners(const PolygonSoup& soup) {
  std::vector<int> corners;
  corners.reserve(soup.corner_vertex.size());
  for (int p = 0; p < soup.polygon_count(); ++p) {
    const auto begin = soup.polygon_begin.begin() + p;
    for (int c = begin[0] + 1; c + 1 < begin[1]; ++c)
      corners.insert(corners.end(), {begin[0], c, c + 1});
  }
  return corners;
}

Vector2d transformed(const Vector2d& uv, const std::optional<TextureTransform>& transform) {
  if (!transform) return uv;
  const double c = std::cos(transform->rotation_radians), s = std::sin(transform->rotation_radians);
  const Vector2d p = uv.cwiseProduct(transform->scale);
  return transform->offset + Vector2d(c * p.x() + s * p.y(), -s * p.x() + c * p.y());
}

}  // namespace crosspatch
