#include "core/laplacian.hpp"

#include <fmt/format.h>

#include "core/index.hpp"
#include "core/intrinsic.hpp"

namespace crosspatch {

Result<Laplacian> compute_laplacian(const TriangleMesh& mesh, const LaplacianOptions& options) {
  IntrinsicMesh surface = intrinsic_mesh(mesh);
  Laplacian result{};
  if (options.mollify > 0) result.mollification = mollify(surface, options.mollify);
  if (options.delaunay) result.flips = make_delaunay(surface);

  const int n = mesh.vertex_count();
  result.mass = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(idx(4 * surface.halfedge_count()));
  for (int f = 0; f < surface.face_count(); ++f) {
    const double area = face_area(surface, f);
    if (!(area > 0) || !std::isfinite(area))
      return fail(ErrorCode::kBadInput, fmt::format("face {}: area {} is not positive", f, area));
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      const int i = surface.from[idx(h)], j = surface.from[idx(next(h))];
      const double weight = cotangent(surface, h) / 2;
      result.mass[i] += area / 3;
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
      entries.emplace_back(i, j, -weight);
      entries.emplace_back(j, i, -weight);
    }
  }
  result.L.resize(n, n);
  result.L.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace crosspatch
