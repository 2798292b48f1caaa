#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.hpp"
#include "tools/samples/creature.hpp"

namespace crosspatch {
namespace {

struct Grid {
  Vector3d origin;
  double cell = 0;
  std::array<int, 3> nodes{};
  std::vector<double> value;  ///< signed distance, x fastest

  [[nodiscard]] int node(int x, int y, int z) const { return (z * nodes[1] + y) * nodes[0] + x; }
  [[nodiscard]] Vector3d place(int x, int y, int z) const {
    return origin + cell * Vector3d(x, y, z);
  }
};

/// `shift`: of the grid, in cells along each axis.
Grid sample(const Creature& creature, double cell, double shift) {
  Vector3d low = Vector3d::Constant(1e9), high = Vector3d::Constant(-1e9);
  for (const Limb& limb : creature.limbs) {
    low = low.cwiseMin((limb.a.array() - limb.radius_a).matrix())
              .cwiseMin((limb.b.array() - limb.radius_b).matrix());
    high = high.cwiseMax((limb.a.array() + limb.radius_a).matrix())
               .cwiseMax((limb.b.array() + limb.radius_b).matrix());
  }
  Grid g;
  g.cell = cell;
  // Three cells of margin hold the swelling where limbs blend.
  g.origin = low.array() - (3 + shift) * cell;
  for (int i = 0; i < 3; ++i) g.nodes[idx(i)] = static_cast<int>((high[i] - low[i]) / cell) + 7;
  for (int z = 0; z < g.nodes[2]; ++z)
    for (int y = 0; y < g.nodes[1]; ++y)
      for (int x = 0; x < g.nodes[0]; ++x)
        g.value.push_back(skin_distance(creature, g.place(x, y, z)));
  return g;
}

/// Mean of the skin's crossings with the edges of the cell, or none without a crossing.
std::vector<Vector3d> cell_vertex(const Grid& g, int x, int y, int z) {
  Vector3d sum = Vector3d::Zero();
  int crossings = 0;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      if ((corner >> axis & 1) != 0) continue;
      std::array<int, 3> p{x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2 & 1)};
      const double a = g.value[idx(g.node(p[0], p[1], p[2]))];
      const Vector3d from = g.place(p[0], p[1], p[2]);
      ++p[idx(axis)];
      const double b = g.value[idx(g.node(p[0], p[1], p[2]))];
      if ((a < 0) == (b < 0)) continue;
      sum += from + a / (a - b) * (g.place(p[0], p[1], p[2]) - from);
      ++crossings;
    }
  if (crossings == 0) return {};
  return {sum / crossings};
}

struct Polygons {
  std::vector<Vector3d> points;
  std::vector<std::array<int, 4>> quads;
};

/// One quad around every grid edge that crosses the skin, joining the four cells at the edge.
Polygons dual_contour(const Grid& g) {
  Polygons out;
  std::vector<int> vertex(g.value.size(), -1);
  for (int z = 0; z + 1 < g.nodes[2]; ++z)
    for (int y = 0; y + 1 < g.nodes[1]; ++y)
      for (int x = 0; x + 1 < g.nodes[0]; ++x)
        for (const Vector3d& p : cell_vertex(g, x, y, z)) {
          vertex[idx(g.node(x, y, z))] = static_cast<int>(out.points.size());
          out.points.push_back(p);
        }
  for (int z = 1; z + 1 < g.nodes[2]; ++z)
    for (int y = 1; y + 1 < g.nodes[1]; ++y)
      for (int x = 1; x + 1 < g.nodes[0]; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          std::array<int, 3> step{0, 0, 0}, u{0, 0, 0}, v{0, 0, 0};
          step[idx(axis)] = 1;
          u[idx((axis + 1) % 3)] = 1;
          v[idx((axis + 2) % 3)] = 1;
          const bool inside = g.value[idx(g.node(x, y, z))] < 0;
          if (inside == (g.value[idx(g.node(x + step[0], y + step[1], z + step[2]))] < 0)) continue;
          const auto cell = [&](int i, int j) {
            return vertex[idx(
                g.node(x - i * u[0] - j * v[0], y - i * u[1] - j * v[1], z - i * u[2] - j * v[2]))];
          };
          std::array<int, 4> quad{cell(1, 1), cell(0, 1), cell(0, 0), cell(1, 0)};
          if (!inside) std::swap(quad[1], quad[3]);
          out.quads.push_back(quad);
        }
  return out;
}

/// Quads cut along their shorter diagonals.
MatrixX3i triangles_of(const Polygons& p) {
  MatrixX3i F(static_cast<Eigen::Index>(2 * p.quads.size()), 3);
  Eigen::Index row = 0;
  for (const auto& [a, b, c, d] : p.quads) {
    const double ac = (p.points[idx(a)] - p.points[idx(c)]).squaredNorm();
    const double bd = (p.points[idx(b)] - p.points[idx(d)]).squaredNorm();
    if (ac <= bd) {
      F.row(row++) << a, b, c;
      F.row(row++) << a, c, d;
    } else {
      F.row(row++) << a, b, d;
      F.row(row++) << b, c, d;
    }
  }
  return F;
}

Vector3d gradient(const Creature& creature, const Vector3d& p) {
  constexpr double kStep = 1e-4;
  Vector3d g;
  for (int i = 0; i < 3; ++i) {
    Vector3d q = p, r = p;
    q[i] += kStep;
    r[i] -= kStep;
    g[i] = (skin_distance(creature, q) - skin_distance(creature, r)) / (2 * kStep);
  }
  return g;
}

/// Evens out the triangles: vertices move to the mean of their neighbours and back to the skin.
void relax(const Creature& creature, TriangleMesh& mesh, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    MatrixX3d V = mesh.V;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      Vector3d mean = Vector3d::Zero();
      int count = 0;
      for_each_outgoing(mesh, v, [&](int h) {
        mean += mesh.position(mesh.to(h));
        ++count;
      });
      Vector3d p = 0.5 * mesh.position(v) + 0.5 * mean / count;
      for (int newton = 0; newton < 2; ++newton) {
        const Vector3d g = gradient(creature, p);
        p -= skin_distance(creature, p) * g / g.squaredNorm();
      }
      V.row(v) = p.transpose();
    }
    mesh.V = V;
  }
}

/// The dual contour as a mesh; kInternal unless it is one closed surface of genus 0.
Result<TriangleMesh> closed_mesh(const Creature& creature, const Grid& grid) {
  const Polygons polygons = dual_contour(grid);
  MatrixX3d V(static_cast<Eigen::Index>(polygons.points.size()), 3);
  for (std::size_t i = 0; i < polygons.points.size(); ++i)
    V.row(static_cast<Eigen::Index>(i)) = polygons.points[i].transpose();
  auto mesh = make_mesh(std::move(V), triangles_of(polygons));
  if (!mesh) return fail(ErrorCode::kInternal, creature.name + ": " + mesh.error().message);
  const std::vector<int> component = face_components(*mesh);
  const int last = *std::max_element(component.begin(), component.end());
  if (last != 0 || euler_characteristic(*mesh) != 2)
    return fail(ErrorCode::kInternal,
                fmt::format("{}: {} components, Euler characteristic {}, wanted 1 and 2",
                            creature.name,
                            last + 1,
                            euler_characteristic(*mesh)));
  return mesh;
}

}  // namespace

Result<TriangleMesh> skin_mesh(const Creature& creature, double edge) {
  // Cells and the edges of their dual are of one size; diagonals are longer.
  const double cell = edge / 1.15;
  // Two sheets of the skin may meet in one cell, which dual contouring cannot tell apart; another
  // place of the grid mends that.
  constexpr int kShifts = 16;
  for (int i = 0;; ++i) {
    auto mesh = closed_mesh(creature, sample(creature, cell, double(i) / kShifts));
    if (!mesh && i + 1 < kShifts) continue;
    if (mesh) relax(creature, *mesh, 12);
    return mesh;
  }
}

}  // namespace crosspatch
