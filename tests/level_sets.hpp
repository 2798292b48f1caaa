#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "core/mesh.hpp"

namespace crosspatch::shapes {

/// Negative inside, with a gradient of length about one near the surface.
using Solid = std::function<double(const Vector3d&)>;

/// Distance to the segment from `a` to `b`, minus a radius that goes from `r` to `s` along it.
inline double capsule(const Vector3d& p, const Vector3d& a, const Vector3d& b, double r, double s) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm() - r - t * (s - r);
}

inline double ring(const Vector3d& p, const Vector3d& axis, double major, double minor) {
  const double height = p.dot(axis), radius = (p - height * axis).norm();
  return std::hypot(radius - major, height) - minor;
}

/// Distance to the union of two solids whose crease is rounded over `width`.
inline double blended(double a, double b, double width) {
  return -width * std::log(std::exp(-a / width) + std::exp(-b / width));
}

inline TriangleMesh mesh_of(const std::vector<Vector3d>& points,
                            const std::vector<std::array<int, 3>>& faces) {
  MatrixX3d V(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v)
    V.row(static_cast<Eigen::Index>(v)) = points[v].transpose();
  MatrixX3i F(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    F.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  return make_mesh(V, F).value();
}

inline Vector3d gradient(const Solid& solid, const Vector3d& p) {
  constexpr double kStep = 1e-5;  // truncation and rounding are both below 1e-9 then
  Vector3d g;
  for (int k = 0; k < 3; ++k) {
    const Vector3d d = kStep * Vector3d::Unit(k);
    g[k] = (solid(p + d) - solid(p - d)) / (2 * kStep);
  }
  return g;
}

inline Vector3d onto_surface(const Solid& solid, Vector3d p) {
  for (int i = 0; i < 4; ++i) {  // Newton's method
    const Vector3d g = gradient(solid, p);
    p -= solid(p) / g.squaredNorm() * g;
  }
  return p;
}

/// Samples the surface of a solid inside the ball of `radius` by marching tetrahedra on a grid of
/// `cell` that is turned by `turn`: another turn or cell samples it elsewhere. Vertices are evened
/// out and lie on the surface.
inline TriangleMesh level_set(const Solid& solid,
                              double radius,
                              double cell,
                              const Eigen::Matrix3d& turn) {
  const int n = static_cast<int>(std::ceil(2 * radius / cell));
  // The offset keeps corners off planes of symmetry, where values could be zero.
  const auto corner = [&](const std::array<int, 3>& c) -> Vector3d {
    return turn *
           (Vector3d(c[0] + 0.31, c[1] + 0.17, c[2] + 0.43) * cell - Vector3d::Constant(radius));
  };
  std::map<std::array<int, 3>, double> values;
  const auto value = [&](const std::array<int, 3>& c) {
    const auto [it, fresh] = values.try_emplace(c, 0);
    if (fresh) it->second = solid(corner(c));
    return it->second;
  };
  using Edge = std::pair<std::array<int, 3>, std::array<int, 3>>;  // from inside to outside
  std::map<Edge, int> vertex_of_edge;
  std::vector<Vector3d> points;
  const auto vertex = [&](const Edge& e) {
    const auto [it, fresh] = vertex_of_edge.try_emplace(e, static_cast<int>(points.size()));
    if (fresh) {
      const double t = value(e.first) / (value(e.first) - value(e.second));
      points.push_back((1 - t) * corner(e.first) + t * corner(e.second));
    }
    return it->second;
  };
  std::vector<std::array<int, 3>> faces;
  const auto add_face = [&](const Edge& a, const Edge& b, const Edge& c) {
    const auto middle = [&](const Edge& e) -> Vector3d {
      return (corner(e.first) + corner(e.second)) / 2;
    };
    const auto across = [&](const Edge& e) -> Vector3d {
      return corner(e.second) - corner(e.first);
    };
    const Vector3d normal = (middle(b) - middle(a)).cross(middle(c) - middle(a));
    if (normal.dot(across(a) + across(b) + across(c)) > 0)
      faces.push_back({vertex(a), vertex(b), vertex(c)});
    else
      faces.push_back({vertex(a), vertex(c), vertex(b)});
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        // The cube's six tetrahedra (Kuhn): along its sides in any order to the far corner.
        std::array<std::size_t, 3> order{0, 1, 2};
        do {
          std::array<int, 3> c{i, j, k};
          std::vector<std::array<int, 3>> in, out;
          for (std::size_t step = 0; step < 4; ++step) {
            (value(c) < 0 ? in : out).push_back(c);
            if (step < 3) ++c[order[step]];
          }
          if (in.size() == 1) {
            add_face({in[0], out[0]}, {in[0], out[1]}, {in[0], out[2]});
          } else if (in.size() == 3) {
            add_face({in[0], out[0]}, {in[1], out[0]}, {in[2], out[0]});
          } else if (in.size() == 2) {
            add_face({in[0], out[0]}, {in[0], out[1]}, {in[1], out[1]});
            add_face({in[0], out[0]}, {in[1], out[1]}, {in[1], out[0]});
          }
        } while (std::next_permutation(order.begin(), order.end()));
      }
  TriangleMesh mesh = mesh_of(points, faces);
  for (int round = 0; round < 4; ++round)
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      Vector3d sum = Vector3d::Zero();
      int count = 0;
      for_each_outgoing(mesh, v, [&](int h) {
        sum += mesh.position(mesh.to(h));
        ++count;
      });
      mesh.V.row(v) = onto_surface(solid, (mesh.position(v) + sum / count) / 2).transpose();
    }
  return mesh;
}

}  // namespace crosspatch::shapes
