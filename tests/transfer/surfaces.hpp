#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "param/surface_map.hpp"
#include "transfer/source_attributes.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch::shapes {

/// A mesh as if it had been read from a file of the same numbering.
struct Surface {
  PreparedMesh prepared;
  PolygonSoup soup;

  [[nodiscard]] AttributedMesh view() const { return {prepared, soup}; }
};

inline Surface surface_of(const TriangleMesh& mesh) {
  Surface s;
  s.prepared.mesh = mesh;
  s.soup.positions = mesh.V;
  for (int v = 0; v < mesh.vertex_count(); ++v) s.prepared.numbering.mesh_vertex.push_back(v);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    s.soup.corner_vertex.push_back(mesh.from(h));
    s.prepared.numbering.soup_corner.push_back(h);
    s.prepared.numbering.triangle_corners.push_back(h);
  }
  for (int f = 0; f < mesh.face_count(); ++f) {
    s.soup.polygon_begin.push_back(3 * (f + 1));
    s.prepared.numbering.file_triangle.push_back(f);
  }
  return s;
}

/// A file that is a PNG as far as its header tells.
inline ImageFile png_header(int width, int height) {
  ImageFile image{"texture.png", "image/png", {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}};
  const auto put = [&](unsigned value) {
    for (unsigned shift : {24U, 16U, 8U, 0U})
      image.bytes.push_back(static_cast<unsigned char>(value >> shift & 255U));
  };
  put(13);
  for (char c : {'I', 'H', 'D', 'R'}) image.bytes.push_back(static_cast<unsigned char>(c));
  put(static_cast<unsigned>(width));
  put(static_cast<unsigned>(height));
  return image;
}

/// Gives every corner the UV `uv(face, position)` and one material with an image of that size.
inline void texture(Surface& s,
                    const std::function<Vector2d(int, const Vector3d&)>& uv,
                    int texels) {
  const TriangleMesh& mesh = s.prepared.mesh;
  s.soup.uv_sets.emplace_back();
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    s.soup.uv_sets.back().push_back(uv(h / 3, mesh.position(mesh.from(h))));
  s.soup.images = {png_header(texels, texels)};
  Material skin;
  skin.name = "skin";
  skin.base_color.image = 0;
  s.soup.materials = {skin};
  s.soup.polygon_material.assign(static_cast<std::size_t>(mesh.face_count()), 0);
}

/// Unit square of n x n quads whose inner vertices are moved at random, z = 0: in general position
/// towards any other such grid, but for the shared outline.
inline TriangleMesh jittered_grid(TriangleMesh grid, int n, unsigned seed) {
  std::mt19937 random(seed);
  const auto jitter = [&] { return (double(random() % 1000) / 1000 - 0.5) * 0.5 / n; };
  for (int v = 0; v < grid.vertex_count(); ++v) {
    const double x = grid.V(v, 0), y = grid.V(v, 1);
    const double dx = jitter(), dy = jitter();
    if (x > 0 && x < 1) grid.V(v, 0) = x + dx;
    if (y > 0 && y < 1) grid.V(v, 1) = y + dy;
    if (x > 0 && x < 1 && (y == 0 || y == 1)) grid.V(v, 1) = y;
    if (y > 0 && y < 1 && (x == 0 || x == 1)) grid.V(v, 0) = x;
  }
  return grid;
}

inline Vector3d planar_barycentric(const TriangleMesh& mesh, int f, const Vector2d& p) {
  const auto corner = [&](int k) -> Vector2d { return mesh.position(mesh.F(f, k)).head<2>(); };
  const auto area = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
  };
  const Vector2d a = corner(0), b = corner(1), c = corner(2);
  return Vector3d(area(p, b, c), area(a, p, c), area(a, b, p)) / area(a, b, c);
}

/// The common subdivision of two triangulations of one planar region, by clipping face by face.
inline SurfaceMap planar_overlay(const TriangleMesh& a, const TriangleMesh& b) {
  SurfaceMap map;
  std::map<std::pair<long, long>, int> found;
  map.point_of_source_vertex.assign(static_cast<std::size_t>(a.vertex_count()), -1);
  map.point_of_target_vertex.assign(static_cast<std::size_t>(b.vertex_count()), -1);
  const auto point = [&](const Vector2d& p, int f, int g) {
    const std::pair<long, long> key(std::lround(p[0] * 1e9), std::lround(p[1] * 1e9));
    const auto [entry, fresh] = found.try_emplace(key, map.point_count());
    if (fresh) {
      map.source.push_back({f, planar_barycentric(a, f, p)});
      map.target.push_back({g, planar_barycentric(b, g, p)});
    }
    for (int k = 0; k < 3; ++k) {
      if ((a.position(a.F(f, k)).head<2>() - p).norm() < 1e-9)
        map.point_of_source_vertex[static_cast<std::size_t>(a.F(f, k))] = entry->second;
      if ((b.position(b.F(g, k)).head<2>() - p).norm() < 1e-9)
        map.point_of_target_vertex[static_cast<std::size_t>(b.F(g, k))] = entry->second;
    }
    return entry->second;
  };
  for (int f = 0; f < a.face_count(); ++f)
    for (int g = 0; g < b.face_count(); ++g) {
      std::vector<Vector2d> polygon;
      for (int k = 0; k < 3; ++k) polygon.emplace_back(a.position(a.F(f, k)).head<2>());
      for (int k = 0; k < 3 && !polygon.empty(); ++k) {  // Sutherland-Hodgman
        std::vector<Vector2d> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
          const Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
          const double s = planar_barycentric(b, g, p)[k], t = planar_barycentric(b, g, q)[k];
          if (s >= -1e-12) kept.push_back(p);
          if ((s > 1e-12 && t < -1e-12) || (s < -1e-12 && t > 1e-12))
            kept.emplace_back(p + s / (s - t) * (q - p));
        }
        polygon = kept;
      }
      std::vector<int> corners;
      double area = 0;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        area += (p[0] * q[1] - p[1] * q[0]) / 2;
      }
      if (area < 1e-12) continue;
      for (const Vector2d& p : polygon) {
        const int q = point(p, f, g);
        if (corners.empty() || (corners.back() != q && corners.front() != q)) corners.push_back(q);
      }
      map.corner.insert(map.corner.end(), corners.begin(), corners.end());
      map.polygon_begin.push_back(static_cast<int>(map.corner.size()));
      map.source_face.push_back(f);
      map.target_face.push_back(g);
    }
  return map;
}

/// Sides of the triangles that have no partner running the other way: on a mesh without
/// T-junctions those of the boundary.
inline int loose_sides(const TexturedMesh& mesh) {
  std::map<std::pair<int, int>, int> sides;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) ++sides[{mesh.triangles(t, k), mesh.triangles(t, (k + 1) % 3)}];
  int loose = 0;
  for (const auto& [side, count] : sides)
    loose += sides.contains({side.second, side.first}) && count == 1 ? 0 : 1;
  return loose;
}

}  // namespace crosspatch::shapes
