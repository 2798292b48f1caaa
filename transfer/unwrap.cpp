#include "transfer/unwrap.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <numeric>

#include "core/index.hpp"
#include "core/union_find.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

constexpr double kBad = 1e-3;  // share of the area that may be wrong: a few slivers
constexpr int kTestSize = 1024;

}  // namespace

Result<Unwrap> own_unwrap(const AttributedMesh& m) {
  const TriangleMesh& mesh = m.prepared.mesh;
  if (m.soup.uv_sets.empty()) return fail(ErrorCode::kBadInput, "it has no texture coordinates");
  Unwrap unwrap;
  unwrap.uv.reserve(idx(mesh.halfedge_count()));
  constexpr double kRounding = 1e-5;
  for (const int corner : m.prepared.numbering.soup_corner) {
    const Vector2d uv = m.soup.uv_sets[0][idx(corner)];
    if (!uv.allFinite()) return fail(ErrorCode::kBadInput, "a corner has no texture coordinates");
    if (uv.minCoeff() < -kRounding || uv.maxCoeff() > 1 + kRounding)
      return fail(
          ErrorCode::kBadInput,
          fmt::format("texture coordinate ({:.4g}, {:.4g}) is outside of [0, 1]", uv[0], uv[1]));
    unwrap.uv.emplace_back(uv.cwiseMax(0.0).cwiseMin(1.0));
  }
  const Eigen::VectorXd area = face_areas(mesh);
  double flat = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto corner = in_texels(unwrap, f, 1);
    if (doubled_area(corner[0], corner[1], corner[2]) == 0) flat += area[f];
  }
  if (flat > kBad * area.sum())
    return fail(ErrorCode::kBadInput,
                fmt::format("{:.2g} of its area has no extent in the image", flat / area.sum()));
  if (const double shared = overlap(unwrap, {}, kTestSize); shared > kBad)
    return fail(ErrorCode::kBadInput,
                fmt::format("{:.2g} of its texels belong to several places", shared));
  return unwrap;
}

std::vector<int> charts_of(const TriangleMesh& mesh, const Unwrap& unwrap) {
  UnionFind joined(mesh.face_count());
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    if (is_joined(mesh, unwrap, h)) joined.join(face_of(h), face_of(mesh.twin[idx(h)]));
  std::vector<int> chart(idx(mesh.face_count()));
  int count = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const int first = joined.find(f);  // never after f
    chart[idx(f)] = first == f ? count++ : chart[idx(first)];
  }
  return chart;
}

double folded_share(const TriangleMesh& mesh, const Unwrap& unwrap) {
  const std::vector<int> chart = charts_of(mesh, unwrap);
  const Eigen::VectorXd area = face_areas(mesh);
  Eigen::VectorXd image = Eigen::VectorXd::Zero(mesh.face_count()), of_chart = image;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto [a, b, c] = in_texels(unwrap, f, 1);
    image[f] = doubled_area(a, b, c);
    of_chart[chart[idx(f)]] += image[f];
  }
  double folded = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (image[f] * of_chart[chart[idx(f)]] < 0) folded += area[f];
  return area.sum() > 0 ? folded / area.sum() : 0;
}

std::array<Vector2d, 3> in_texels(const Unwrap& unwrap, int face, int size) {
  return {unwrap.uv[idx(3 * face)] * size,
          unwrap.uv[idx(3 * face + 1)] * size,
          unwrap.uv[idx(3 * face + 2)] * size};
}

bool is_joined(const TriangleMesh& mesh, const Unwrap& unwrap, int h) {
  constexpr double kEqual = 1e-8;
  const int twin = mesh.twin[idx(h)];
  return twin >= 0 &&
         (unwrap.uv[idx(h)] - unwrap.uv[idx(next(twin))]).cwiseAbs().maxCoeff() < kEqual &&
         (unwrap.uv[idx(next(h))] - unwrap.uv[idx(twin)]).cwiseAbs().maxCoeff() < kEqual;
}

double overlap(const Unwrap& unwrap, const std::vector<int>& faces, int size) {
  // Sides that two faces share must not count.
  constexpr double kMargin = -1e-3;
  std::vector<std::uint8_t> count(idx(size) * idx(size), 0);
  const auto add = [&](int f) {
    for_each_texel(
        in_texels(unwrap, f, size), kMargin, {0, size}, size, [&](int x, int y, const Vector3d&) {
          std::uint8_t& n = count[idx(y) * idx(size) + idx(x)];
          n = static_cast<std::uint8_t>(std::min(2, n + 1));
        });
  };
  if (faces.empty())
    for (int f = 0; f < static_cast<int>(unwrap.uv.size()) / 3; ++f) add(f);
  else
    for (const int f : faces) add(f);
  long covered = 0, shared = 0;
  for (const std::uint8_t n : count) {
    covered += n > 0 ? 1 : 0;
    shared += n > 1 ? 1 : 0;
  }
  return covered > 0 ? static_cast<double>(shared) / static_cast<double>(covered) : 0;
}

}  // namespace crosspatch
