#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/mesh.hpp"

namespace crosspatch::shapes {

inline TriangleMesh tetrahedron() {
  MatrixX3d V(4, 3);
  V << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  MatrixX3i F(4, 3);
  F << 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2;
  return make_mesh(V, F).value();
}

/// Unit icosahedron subdivided 1:4 `levels` times: 20 * 4^levels faces on the unit sphere.
inline TriangleMesh icosphere(int levels) {
  const double t = std::numbers::phi;
  MatrixX3d V(12, 3);
  V << -1, t, 0, 1, t, 0, -1, -t, 0, 1, -t, 0, 0, -1, t, 0, 1, t, 0, -1, -t, 0, 1, -t, t, 0, -1, t,
      0, 1, -t, 0, -1, -t, 0, 1;
  MatrixX3i F(20, 3);
  F << 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7,
      1, 8, 3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8,
      1;
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    MatrixX3i G(4 * F.rows(), 3);
    const auto midpoint = [&](int a, int b) {
      const auto [it, fresh] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(V.rows()));
      if (fresh) {
        V.conservativeResize(V.rows() + 1, 3);
        V.row(it->second) = (V.row(a) + V.row(b)) / 2;
      }
      return it->second;
    };
    for (int f = 0; f < F.rows(); ++f) {
      const int a = F(f, 0), b = F(f, 1), c = F(f, 2);
      const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      G.middleRows(4 * f, 4) << a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca;
    }
    F = G;
  }
  V.rowwise().normalize();
  return make_mesh(V, F).value();
}

/// Flat n x n grid of squares on [0, 1]^2 at z = 0, each cut along one diagonal; normal +z.
inline TriangleMesh grid(int n) {
  MatrixX3d V((n + 1) * (n + 1), 3);
  MatrixX3i F(2 * n * n, 3);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) V.row(j * (n + 1) + i) << double(i) / n, double(j) / n, 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, f = 2 * (j * n + i);
      F.row(f) << a, a + 1, a + n + 2;
      F.row(f + 1) << a, a + n + 2, a + n + 1;
    }
  return make_mesh(V, F).value();
}

/// Torus of revolution about z: `rings` around the axis, `sides` around the tube.
inline TriangleMesh torus(double major, double minor, int rings, int sides) {
  MatrixX3d V(rings * sides, 3);
  MatrixX3i F(2 * rings * sides, 3);
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sides; ++j) {
      const double u = 2 * std::numbers::pi * i / rings, v = 2 * std::numbers::pi * j / sides;
      const double r = major + minor * std::cos(v);
      V.row(i * sides + j) << r * std::cos(u), r * std::sin(u), minor * std::sin(v);
      const int a = i * sides + j, b = (i + 1) % rings * sides + j;
      const int c = (i + 1) % rings * sides + (j + 1) % sides, d = i * sides + (j + 1) % sides;
      F.row(2 * (i * sides + j)) << a, b, c;
      F.row(2 * (i * sides + j) + 1) << a, c, d;
    }
  return make_mesh(V, F).value();
}

/// Two tori side by side, each without a triangle, joined by a tube of six.
inline TriangleMesh double_torus() {
  const TriangleMesh a = torus(3, 1, 24, 12);
  const int n = a.vertex_count(), m = a.face_count();
  MatrixX3d V(2 * n, 3);
  V << a.V, a.V.rowwise() + Eigen::RowVector3d(9, 0, 0);
  MatrixX3i F(2 * (m - 1) + 6, 3);
  F.topRows(m - 1) = a.F.topRows(m - 1);
  F.middleRows(m - 1, m - 1) = a.F.topRows(m - 1).array() + n;
  const Eigen::RowVector3i p = a.F.row(m - 1), q = p.array() + n;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3;
    F.row(2 * (m - 1) + 2 * k) << p[k], p[i], q[(3 - k) % 3];
    F.row(2 * (m - 1) + 2 * k + 1) << p[i], q[(3 - i) % 3], q[(3 - k) % 3];
  }
  return make_mesh(V, F).value();
}

/// Every face cut into four at the middles of its sides, which stay where they are: corners keep
/// their numbers, rows 4 f to 4 f + 3 are the parts of face f, the last the one in its midst.
inline TriangleMesh refined(const TriangleMesh& mesh) {
  MatrixX3d V = mesh.V;
  MatrixX3i F(4 * mesh.face_count(), 3);
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [it, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(V.rows()));
    if (fresh) {
      V.conservativeResize(V.rows() + 1, 3);
      V.row(it->second) = (V.row(a) + V.row(b)) / 2;
    }
    return it->second;
  };
  for (int f = 0; f < mesh.face_count(); ++f) {
    const int a = mesh.F(f, 0), b = mesh.F(f, 1), c = mesh.F(f, 2);
    const int x = middle(a, b), y = middle(b, c), z = middle(c, a);
    F.middleRows(4 * f, 4) << a, x, z, b, y, x, c, z, y, x, y, z;
  }
  return make_mesh(V, F).value();
}

}  // namespace crosspatch::shapes
