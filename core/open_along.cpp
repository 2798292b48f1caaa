#include "core/open_along.hpp"

#include <numeric>

#include "core/union_find.hpp"

namespace crosspatch {

Result<OpenedMesh> open_along(const TriangleMesh& mesh, const std::vector<bool>& marked) {
  UnionFind corners(mesh.halfedge_count());
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const int twin = mesh.twin[idx(h)];
    if (twin < 0 || marked[idx(h)]) continue;
    corners.join(h, next(twin));
    corners.join(next(h), twin);
  }
  OpenedMesh opened{{}, std::vector<int>(idx(mesh.vertex_count()))};
  std::iota(opened.vertex.begin(), opened.vertex.end(), 0);
  std::vector<int> vertex_of(idx(mesh.halfedge_count()), -1);
  std::vector<bool> taken(idx(mesh.vertex_count()), false);
  MatrixX3i F = mesh.F;
  for (int c = 0; c < mesh.halfedge_count(); ++c) {
    int& v = vertex_of[idx(corners.find(c))];
    const int old = mesh.from(c);
    if (v < 0 && !taken[idx(old)]) {
      taken[idx(old)] = true;
      v = old;
    } else if (v < 0) {
      v = static_cast<int>(opened.vertex.size());
      opened.vertex.push_back(old);
    }
    F(c / 3, c % 3) = v;
  }
  MatrixX3d V(static_cast<Eigen::Index>(opened.vertex.size()), 3);
  for (std::size_t i = 0; i < opened.vertex.size(); ++i)
    V.row(static_cast<Eigen::Index>(i)) = mesh.V.row(opened.vertex[i]);
  auto made = make_mesh(std::move(V), std::move(F));
  if (!made) return tl::unexpected(made.error());
  opened.mesh = std::move(*made);
  return opened;
}

}  // namespace crosspatch
