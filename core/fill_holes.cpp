#include "core/fill_holes.hpp"

namespace crosspatch {

Result<FilledMesh> fill_holes(const TriangleMesh& mesh) {
  const std::vector<std::vector<int>> loops = boundary_loops(mesh);
  FilledMesh filled{mesh, mesh.vertex_count(), mesh.face_count(), static_cast<int>(loops.size())};
  if (loops.empty()) return filled;
  MatrixX3d V = mesh.V;
  MatrixX3i F = mesh.F;
  const auto add_face = [&](int a, int b, int c) {
    F.conservativeResize(F.rows() + 1, Eigen::NoChange);
    F.bottomRows<1>() << a, b, c;
  };
  for (const std::vector<int>& loop : loops) {
    const std::size_t n = loop.size();
    if (n == 3) {
      add_face(loop[2], loop[1], loop[0]);
      continue;
    }
    const int center = static_cast<int>(V.rows());
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (const int v : loop) middle += mesh.V.row(v) / static_cast<double>(n);
    V.conservativeResize(V.rows() + 1, Eigen::NoChange);
    V.bottomRows<1>() = middle;
    // The surface is on the loop's left, the cap on its right.
    for (std::size_t i = 0; i < n; ++i) add_face(loop[(i + 1) % n], loop[i], center);
  }
  auto made = make_mesh(std::move(V), std::move(F));
  if (!made) return tl::unexpected(made.error());
  filled.mesh = std::move(*made);
  return filled;
}

}  // namespace crosspatch
