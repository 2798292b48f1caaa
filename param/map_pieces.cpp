#include "param/map_pieces.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/index.hpp"

namespace crosspatch {
namespace {

SurfacePoint snapped(int face, Vector3d bary) {
  // What rounding leaves on a corner that has no weight; far below what single precision resolves.
  constexpr double kNothing = 1e-9;
  for (double& weight : bary)
    if (weight < kNothing) weight = 0;
  return {face, bary / bary.sum()};
}

}  // namespace

MapPieces::MapPieces(const SurfaceMap& map, const TriangleMesh& source, const TriangleMesh& target)
    : source_(source), begin_(idx(source.face_count()) + 1, 0) {
  std::vector<int> order(idx(map.polygon_count()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int p, int q) {
    return map.source_face[idx(p)] < map.source_face[idx(q)];
  });
  for (const int p : order) {
    const int fa = map.source_face[idx(p)], fb = map.target_face[idx(p)];
    const int first = map.polygon_begin[idx(p)], end = map.polygon_begin[idx(p + 1)];
    for (int i = first + 1; i + 1 < end; ++i) {
      Eigen::Matrix3d a, b;
      int column = 0;
      for (const int corner : {first, i, i + 1}) {
        const int q = map.corner[idx(corner)];
        a.col(column) = in_face(source, map.source[idx(q)], fa).bary;
        b.col(column++) = in_face(target, map.target[idx(q)], fb).bary;
      }
      // The determinant is the share of the face that the piece takes: slivers of rounding, which
      // their neighbours cover too, cannot be inverted.
      constexpr double kSliver = 1e-13;
      if (std::abs(a.determinant()) < kSliver) continue;
      pieces_.push_back({a.inverse(), b, fb});
      ++begin_[idx(fa) + 1];
    }
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
}

SurfacePoint MapPieces::image_in_face(const SurfacePoint& p) const {
  // Barycentric, in the piece: gaps between pieces that rounding leaves.
  double best = -1e-6;
  SurfacePoint found;
  for (int i = begin_[idx(p.face)]; i < begin_[idx(p.face) + 1]; ++i) {
    const Piece& piece = pieces_[idx(i)];
    const Vector3d weights = piece.weights * p.bary;
    if (weights.minCoeff() <= best) continue;
    best = weights.minCoeff();
    found = snapped(piece.target_face, piece.corners * weights.cwiseMax(0.0));
  }
  return found;
}

SurfacePoint MapPieces::image(const SurfacePoint& p) const {
  if (!p.valid()) return {};
  for (const int face : faces_at(source_, p))
    if (const SurfacePoint q = image_in_face(in_face(source_, p, face)); q.valid()) return q;
  return {};
}

std::vector<ImageChord> MapPieces::image(int face, const Vector3d& from, const Vector3d& to) const {
  // Parts of the segment that are shorter are not worth a point of their own.
  constexpr double kShort = 1e-9;
  struct Part {
    double begin, end;
    const Piece* piece;
  };
  std::vector<Part> parts;
  for (int i = begin_[idx(face)]; i < begin_[idx(face) + 1]; ++i) {
    const Vector3d a = pieces_[idx(i)].weights * from, b = pieces_[idx(i)].weights * to;
    double begin = 0, end = 1;
    for (int k = 0; k < 3 && begin < end; ++k) {
      constexpr double kRounding = 1e-12;  // a segment along a side belongs to both its pieces
      const double a_k = a[k] + kRounding, b_k = b[k] + kRounding;
      if (a_k < 0 && b_k < 0) end = -1;
      if (a_k < 0 && b_k >= 0) begin = std::max(begin, a_k / (a_k - b_k));
      if (a_k >= 0 && b_k < 0) end = std::min(end, a_k / (a_k - b_k));
    }
    if (end - begin > kShort) parts.push_back({begin, end, &pieces_[idx(i)]});
  }
  std::stable_sort(parts.begin(), parts.end(), [](const Part& x, const Part& y) {
    return x.begin != y.begin ? x.begin < y.begin : x.end > y.end;
  });
  std::vector<ImageChord> chords;
  double reached = 0;
  for (const Part& part : parts) {
    if (part.end <= reached + kShort) continue;  // covered already
    const double begin = std::max(part.begin, reached);
    const auto at = [&](double t) {
      const Vector3d weights = part.piece->weights * (from + t * (to - from));
      return snapped(part.piece->target_face, part.piece->corners * weights.cwiseMax(0.0));
    };
    chords.push_back({begin, part.end, at(begin), at(part.end)});
    reached = part.end;
  }
  return chords;
}

}  // namespace crosspatch
