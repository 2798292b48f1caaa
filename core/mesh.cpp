#include "core/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

Status check_corners(const MatrixX3d& V, const MatrixX3i& F) {
  for (int f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (F(f, k) < 0 || F(f, k) >= V.rows())
        return fail(ErrorCode::kBadInput,
                    fmt::format("face {}: vertex {} is outside [0, {})", f, F(f, k), V.rows()));
      if (F(f, k) == F(f, (k + 1) % 3))
        return fail(ErrorCode::kBadInput,
                    fmt::format("face {}: vertex {} is repeated", f, F(f, k)));
    }
  }
  return {};
}

/// Pairs half-edges by sorting them on their undirected edge.
Result<std::vector<int>> pair_halfedges(const MatrixX3i& F) {
  struct Side {
    std::int64_t edge;
    int h;
    bool forward;
  };
  const int count = static_cast<int>(3 * F.rows());
  std::vector<Side> sides(at(count));
  for (int h = 0; h < count; ++h) {
    const int u = F(h / 3, h % 3), v = F(h / 3, (h + 1) % 3);
    sides[at(h)] = {(static_cast<std::int64_t>(std::min(u, v)) << 32) | std::max(u, v), h, u < v};
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.h < b.h;
  });
  std::vector<int> twin(at(count), -1);
  for (size_t i = 0; i < sides.size();) {
    size_t j = i + 1;
    while (j < sides.size() && sides[j].edge == sides[i].edge) ++j;
    const int u = static_cast<int>(sides[i].edge >> 32);
    const int v = static_cast<int>(sides[i].edge & 0xffffffff);
    if (j - i > 2)
      return fail(ErrorCode::kBadInput,
                  fmt::format("edge ({}, {}): {} faces meet there, at most 2 can", u, v, j - i));
    if (j - i == 2) {
      if (sides[i].forward == sides[i + 1].forward)
        return fail(ErrorCode::kBadInput,
                    fmt::format("edge ({}, {}): its two faces have opposite orientations", u, v));
      twin[at(sides[i].h)] = sides[i + 1].h;
      twin[at(sides[i + 1].h)] = sides[i].h;
    }
    i = j;
  }
  return twin;
}

/// Chooses out[v] and counts the half-edges its fan reaches.
Status find_outgoing(TriangleMesh& mesh) {
  const size_t n = at(mesh.vertex_count());
  mesh.out.assign(n, -1);
  std::vector<int> degree(n, 0);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const int v = mesh.from(h);
    ++degree[at(v)];
    if (mesh.out[at(v)] < 0 || mesh.twin[at(h)] < 0) mesh.out[at(v)] = h;
  }
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (degree[at(v)] == 0)
      return fail(ErrorCode::kBadInput, fmt::format("vertex {}: no face uses it", v));
    int reached = 0;
    for_each_outgoing(mesh, v, [&](int) { ++reached; });
    if (reached != degree[at(v)])
      return fail(
          ErrorCode::kBadInput,
          fmt::format(
              "vertex {}: its {} faces are not one fan ({} reached)", v, degree[at(v)], reached));
  }
  return {};
}

}  // namespace

Result<TriangleMesh> make_mesh(MatrixX3d V, MatrixX3i F) {
  if (Status s = check_corners(V, F); !s) return tl::unexpected(s.error());
  auto twin = pair_halfedges(F);
  if (!twin) return tl::unexpected(twin.error());
  TriangleMesh mesh{std::move(V), std::move(F), std::move(*twin), {}};
  if (Status s = find_outgoing(mesh); !s) return tl::unexpected(s.error());
  return mesh;
}

Status validate(const TriangleMesh& mesh) {
  if (Status s = check_corners(mesh.V, mesh.F); !s) return s;
  if (mesh.twin.size() != at(mesh.halfedge_count()) || mesh.out.size() != at(mesh.vertex_count()))
    return fail(ErrorCode::kInternal, "mesh: twin or out has the wrong size");
  const auto twin = pair_halfedges(mesh.F);
  if (!twin) return tl::unexpected(twin.error());
  if (*twin != mesh.twin) return fail(ErrorCode::kInternal, "mesh: twin does not match the faces");
  TriangleMesh copy = mesh;
  if (Status s = find_outgoing(copy); !s) return s;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const int h = mesh.out[at(v)];
    if (h < 0 || mesh.from(h) != v)
      return fail(ErrorCode::kInternal, fmt::format("vertex {}: out {} does not leave it", v, h));
    if ((mesh.twin[at(copy.out[at(v)])] < 0) != (mesh.twin[at(h)] < 0))
      return fail(ErrorCode::kInternal,
                  fmt::format("vertex {}: out {} is not on the boundary", v, h));
  }
  return {};
}

int find_halfedge(const TriangleMesh& mesh, int u, int v) {
  int found = -1;
  for_each_outgoing(mesh, u, [&](int h) {
    if (mesh.to(h) == v) found = h;
  });
  return found;
}

int euler_characteristic(const TriangleMesh& mesh) {
  int edges = 0;
  for (int h = 0; h < mesh.halfedge_count(); ++h) edges += mesh.twin[at(h)] < h ? 1 : 0;
  return mesh.vertex_count() - edges + mesh.face_count();
}

std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> loops;
  std::vector<bool> seen(at(mesh.halfedge_count()), false);
  for (int start = 0; start < mesh.halfedge_count(); ++start) {
    if (mesh.twin[at(start)] >= 0 || seen[at(start)]) continue;
    std::vector<int> loop;
    for (int h = start; !seen[at(h)]; h = mesh.out[at(mesh.to(h))]) {
      seen[at(h)] = true;
      loop.push_back(mesh.from(h));
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

int genus(const TriangleMesh& mesh) {
  return (2 - euler_characteristic(mesh) - static_cast<int>(boundary_loops(mesh).size())) / 2;
}

std::vector<int> face_components(const TriangleMesh& mesh) {
  std::vector<int> component(at(mesh.face_count()), -1);
  int count = 0;
  std::vector<int> stack;
  for (int seed = 0; seed < mesh.face_count(); ++seed) {
    if (component[at(seed)] >= 0) continue;
    component[at(seed)] = count;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int t = mesh.twin[at(3 * f + k)];
        if (t < 0 || component[at(t / 3)] >= 0) continue;
        component[at(t / 3)] = count;
        stack.push_back(t / 3);
      }
    }
    ++count;
  }
  return component;
}

Eigen::VectorXd face_areas(const TriangleMesh& mesh) {
  Eigen::VectorXd areas(mesh.face_count());
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3d a = mesh.position(mesh.F(f, 0));
    areas[f] =
        0.5 * (mesh.position(mesh.F(f, 1)) - a).cross(mesh.position(mesh.F(f, 2)) - a).norm();
  }
  return areas;
}

double total_area(const TriangleMesh& mesh) {
  return face_areas(mesh).sum();
}

MatrixX3d vertex_normals(const TriangleMesh& mesh) {
  MatrixX3d normals = MatrixX3d::Zero(mesh.vertex_count(), 3);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3d a = mesh.position(mesh.F(f, 0));
    const Vector3d n = (mesh.position(mesh.F(f, 1)) - a).cross(mesh.position(mesh.F(f, 2)) - a);
    for (int k = 0; k < 3; ++k) normals.row(mesh.F(f, k)) += n.transpose();
  }
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 0) normals.row(v) /= length;
  }
  return normals;
}

TriangleMesh normalized(TriangleMesh mesh) {
  const Eigen::VectorXd areas = face_areas(mesh);
  Vector3d centroid = Vector3d::Zero();
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) centroid += areas[f] / 3 * mesh.position(mesh.F(f, k));
  centroid /= areas.sum();
  mesh.V = ((mesh.V.rowwise() - centroid.transpose()) / std::sqrt(areas.sum())).eval();
  return mesh;
}

}  // namespace crosspatch
