#include "param/face_subdivision.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Polygon = std::vector<int>;  ///< indices into the boundary points

/// The sides of the triangle that hold all of the points, as bits.
int common_sides(const std::vector<FacePoint>& points, std::initializer_list<int> which) {
  int sides = 7;
  for (const int i : which)
    for (int k = 0; k < 3; ++k)
      if (points[idx(i)].bary[k] != 0) sides &= ~(1 << k);
  return sides;
}

bool flat(const std::vector<FacePoint>& points, const Polygon& polygon) {
  int sides = 7;
  for (const int i : polygon) sides &= common_sides(points, {i});
  return sides != 0;
}

/// Cuts the polygon that has both ends of the chord in two; false if there is none, or the chord is
/// a side.
bool split(std::vector<Polygon>& polygons, const std::array<int, 2>& chord) {
  for (Polygon& polygon : polygons) {
    const auto a = std::find(polygon.begin(), polygon.end(), chord[0]);
    const auto b = std::find(polygon.begin(), polygon.end(), chord[1]);
    if (a == polygon.end() || b == polygon.end()) continue;
    const auto [first, last] = std::minmax(a, b);
    const Polygon inner(first, last + 1);
    Polygon outer(polygon.begin(), first + 1);
    outer.insert(outer.end(), last, polygon.end());
    if (inner.size() < 3 || outer.size() < 3) return false;
    polygon = inner;
    polygons.push_back(std::move(outer));
    return true;
  }
  return false;
}

/// Smallest sine of the triangle's angles.
double width(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double twice_area = (b - a).cross(c - a).norm();
  const double x = (b - a).norm(), y = (c - b).norm(), z = (a - c).norm();
  const double longest_two = std::max({x * y, y * z, z * x});
  return longest_two > 0 ? twice_area / longest_two : 0;
}

/// Clips the widest ear that leaves something of positive area, until a triangle is left.
bool clip_ears(const Eigen::Matrix3d& corners,
               const std::vector<FacePoint>& points,
               Polygon polygon,
               std::vector<std::array<int, 3>>& triangles) {
  const auto position = [&](int i) -> Vector3d {
    return corners.transpose() * points[idx(i)].bary;
  };
  while (polygon.size() >= 3) {
    const size_t n = polygon.size();
    double best = -1;
    size_t ear = n;
    for (size_t i = 0; i < n; ++i) {
      const int a = polygon[(i + n - 1) % n], b = polygon[i], c = polygon[(i + 1) % n];
      if (common_sides(points, {a, b, c}) != 0) continue;
      Polygon rest = polygon;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      if (rest.size() >= 3 && flat(points, rest)) continue;
      const double w = width(position(a), position(b), position(c));
      if (w > best) {
        best = w;
        ear = i;
      }
    }
    if (ear == n) return false;
    triangles.push_back({points[idx(polygon[(ear + n - 1) % n])].vertex,
                         points[idx(polygon[ear])].vertex,
                         points[idx(polygon[(ear + 1) % n])].vertex});
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return true;
}

/// Joins the centre, placed amid the polygon, to each of its sides.
void fan(const std::vector<FacePoint>& points,
         const Polygon& polygon,
         int centre,
         FaceSubdivision& result) {
  result.centre.setZero();
  for (size_t i = 0; i < polygon.size(); ++i) {
    result.centre += points[idx(polygon[i])].bary / static_cast<double>(polygon.size());
    result.triangles.push_back({points[idx(polygon[i])].vertex,
                                points[idx(polygon[(i + 1) % polygon.size()])].vertex,
                                centre});
  }
}

}  // namespace

FaceSubdivision subdivide_face(const Eigen::Matrix3d& corners,
                               const std::vector<FacePoint>& boundary,
                               const std::vector<std::array<int, 2>>& chords,
                               const std::optional<FaceCentre>& centre) {
  std::vector<Polygon> polygons(1);
  for (int i = 0; i < static_cast<int>(boundary.size()); ++i) polygons[0].push_back(i);
  for (const std::array<int, 2>& chord : chords)
    if (!split(polygons, chord)) return {};
  FaceSubdivision result;
  bool placed = !centre;
  for (const Polygon& polygon : polygons) {
    const auto has = [&](int i) {
      return std::find(polygon.begin(), polygon.end(), i) != polygon.end();
    };
    if (!placed && std::all_of(centre->spokes.begin(), centre->spokes.end(), has) &&
        std::none_of(centre->outside.begin(), centre->outside.end(), has)) {
      fan(boundary, polygon, centre->vertex, result);
      placed = true;
    } else if (!clip_ears(corners, boundary, polygon, result.triangles)) {
      return {};
    }
  }
  return placed ? result : FaceSubdivision{};
}

}  // namespace crosspatch
