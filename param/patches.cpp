#include "param/patches.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/blas.hpp"
#include "core/index.hpp"
#include "param/tutte.hpp"

namespace crosspatch {
namespace {

using std::size_t;

double path_length(const TriangleMesh& mesh, const std::vector<int>& path) {
  double length = 0;
  for (size_t i = 1; i < path.size(); ++i)
    length += (mesh.V.row(path[i]) - mesh.V.row(path[i - 1])).norm();
  return length;
}

/// Per arc: the shares at which either surface has a vertex.
std::vector<std::vector<double>> common_fractions(const DrawnLayout& a, const DrawnLayout& b) {
  std::vector<std::vector<double>> fractions(a.path.size());
  for (size_t arc = 0; arc < a.path.size(); ++arc) {
    const std::vector<double> s = arc_fractions(a.mesh, a.path[arc]);
    const std::vector<double> t = arc_fractions(b.mesh, b.path[arc]);
    std::set_union(s.begin(), s.end(), t.begin(), t.end(), std::back_inserter(fractions[arc]));
  }
  return fractions;
}

/// Sides of the rectangle for a face: in the ratio of the arcs' lengths on both surfaces, each
/// relative to the surface's size, rounded to powers of two so that positions are exact.
Vector2d rectangle_size(const DrawnLayout& a, const DrawnLayout& b, int face, double aspect) {
  const std::vector<int> darts = darts_of_face(a.layout, face);
  Vector2d length = Vector2d::Zero();
  for (size_t k = 0; k < 4; ++k) {
    const size_t arc = idx(darts[k] / 2);
    length[static_cast<Eigen::Index>(k % 2)] +=
        path_length(a.mesh, a.path[arc]) / std::sqrt(total_area(a.mesh)) +
        path_length(b.mesh, b.path[arc]) / std::sqrt(total_area(b.mesh));
  }
  const double most = std::floor(std::log2(std::max(aspect, 1.0)));
  const double ratio = length.minCoeff() > 0 ? std::log2(length[0] / length[1]) : 0;
  return {std::exp2(std::clamp(std::round(ratio), -most, most)), 1};
}

MatrixX2d on_rectangle(const PatchDisc& disc,
                       const QuadLayout& layout,
                       int face,
                       const Vector2d& size) {
  const std::vector<int> darts = darts_of_face(layout, face);
  const double x = size.x() / 2, y = size.y() / 2;
  MatrixX2d p(static_cast<Eigen::Index>(disc.loop.size()), 2);
  for (size_t i = 0; i < disc.loop.size(); ++i) {
    const int k = disc.side[i];
    const double s = darts[idx(k)] % 2 == 0 ? disc.share[i] : 1 - disc.share[i];
    const auto row = static_cast<Eigen::Index>(i);
    if (k == 0) p.row(row) << -x + s * size.x(), -y;
    if (k == 1) p.row(row) << x, -y + s * size.y();
    if (k == 2) p.row(row) << x - s * size.x(), y;
    if (k == 3) p.row(row) << -x, y - s * size.y();
  }
  return p;
}

Result<PatchParametrization> flatten(const PatchDisc& disc,
                                     const MatrixX2d& rectangle,
                                     const ParametrizeOptions& options) {
  // Limbs would start with energies of 1e8; evened out they start below 1e3 and need fewer rounds.
  const auto start = tutte_embedding(disc.mesh, disc.loop, rectangle, {.evening_rounds = 4});
  if (!start) return tl::unexpected(start.error());
  return parametrize(disc.mesh, *start, options);
}

}  // namespace

Result<std::vector<PatchPair>> parametrize_patches(const DrawnLayout& source,
                                                   const DrawnLayout& target,
                                                   const PatchOptions& options) {
  if (source.layout.node != target.layout.node || source.layout.sigma != target.layout.sigma)
    return fail(ErrorCode::kBadInput, "patches: the two layouts differ");
  const int count = source.layout.face_count;
  const PatchCutter cut_source(source), cut_target(target);
  const std::vector<std::vector<double>> fractions = common_fractions(source, target);
  ParametrizeOptions fixed = options.parametrize;
  fixed.boundary = PatchBoundary::kFixed;
  std::vector<PatchPair> pairs(idx(count));
  std::vector<Status> status(2 * idx(count));
  const SingleThreadedBlas one_thread;
  tbb::parallel_for(0, 2 * count, [&](int i) {
    const int face = i / 2;
    const bool first = i % 2 == 0;
    PatchPair& pair = pairs[idx(face)];
    auto disc = (first ? cut_source : cut_target).cut(face, fractions);
    if (!disc) {
      status[idx(i)] = tl::unexpected(disc.error());
      return;
    }
    const Vector2d size = rectangle_size(source, target, face, options.largest_aspect);
    auto chart = flatten(*disc, on_rectangle(*disc, source.layout, face, size), fixed);
    if (!chart) {
      status[idx(i)] = fail(
          chart.error().code,
          fmt::format(
              "patch {} of the {}: {}", face, first ? "source" : "target", chart.error().message));
      return;
    }
    if (first) pair.size = size;
    (first ? pair.source : pair.target) = std::move(*disc);
    (first ? pair.source_chart : pair.target_chart) = std::move(*chart);
  });
  for (const Status& s : status)
    if (!s) return tl::unexpected(s.error());
  return pairs;
}

}  // namespace crosspatch
