#include "transfer/carry_skin.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// A piece of the surface in the middle of a polygon of the map.
struct Piece {
  double area = 0;  ///< geometric mean of both sides
  Vector3d source = Vector3d::Zero(), target = Vector3d::Zero();
  SurfacePoint on_source;
};

Piece piece_of(const TriangleMesh& source,
               const TriangleMesh& target,
               const SurfaceMap& map,
               int polygon) {
  const int begin = map.polygon_begin[idx(polygon)], end = map.polygon_begin[idx(polygon + 1)];
  const auto at = [&](int i, bool there) {
    const int q = map.corner[idx(i)];
    return there ? position(target, map.target[idx(q)]) : position(source, map.source[idx(q)]);
  };
  Piece piece;
  piece.on_source.face = map.source_face[idx(polygon)];
  Vector3d here = Vector3d::Zero(), there = Vector3d::Zero();
  for (int i = begin; i < end; ++i) {
    piece.source += at(i, false) / (end - begin);
    piece.target += at(i, true) / (end - begin);
    piece.on_source.bary +=
        in_face(source, map.source[idx(map.corner[idx(i)])], piece.on_source.face).bary /
        (end - begin);
    if (i < begin + 2) continue;
    here += (at(i - 1, false) - at(begin, false)).cross(at(i, false) - at(begin, false)) / 2;
    there += (at(i - 1, true) - at(begin, true)).cross(at(i, true) - at(begin, true)) / 2;
  }
  piece.area = std::sqrt(here.norm() * there.norm());
  return piece;
}

/// Per node, the share of a piece that follows it or a node below it; empty if nothing is followed.
std::vector<double> shares(const Skin& skin, const AttributedMesh& source, const SurfacePoint& p) {
  std::vector<double> share(skin.nodes.size(), 0.0);
  double total = 0;
  for (int k = 0; k < 3; ++k) {
    const int corner = source.prepared.numbering.soup_corner[idx(3 * p.face + k)];
    const int vertex = source.soup.corner_vertex[idx(corner)];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, vertex); w;
         ++w) {
      share[idx(skin.joints[idx(w.col())])] += p.bary[k] * w.value();
      total += p.bary[k] * w.value();
    }
  }
  if (!(total > 0)) return {};
  for (std::size_t n = skin.nodes.size(); n-- > 0;) {
    if (skin.nodes[n].parent >= 0) share[idx(skin.nodes[n].parent)] += share[n];
    share[n] = std::clamp(share[n] / total, 0.0, 1.0);
  }
  return share;
}

Eigen::Quaterniond turn_of(const Eigen::Matrix4d& frame) {
  return Eigen::Quaterniond(nearest_turn(frame.topLeftCorner<3, 3>()));
}

/// How the tracks of one node change: they are affine in what they say.
struct TrackChange {
  Eigen::Quaterniond left, right;  ///< q' = left q right
  Eigen::Matrix3d linear;          ///< t' = rest + linear (t - bind)
  Vector3d bind, rest;
  Vector3d scale;  ///< of the bind pose
};

TrackChange change_of(const SkeletonNode& from, const SkeletonNode& to, const Similarity& fit) {
  const Eigen::Matrix4d outer = from.bind * from.local.inverse();
  const Placement local = placement(from.local);
  const Eigen::Quaterniond turn(fit.turn);
  TrackChange change;
  change.left = turn * turn_of(outer);
  change.right = (change.left * local.rotation).inverse();
  change.linear = fit.scale * fit.turn * outer.topLeftCorner<3, 3>();
  change.bind = local.translation;
  change.rest = to.local.topRightCorner<3, 1>();
  change.scale = local.scale;
  return change;
}

/// `is_value`: and not a tangent, which constants do not change.
void apply(const TrackChange& change, TrackPath path, bool is_value, double* numbers) {
  if (path == TrackPath::kRotation) {
    const Eigen::Quaterniond q(numbers[3], numbers[0], numbers[1], numbers[2]);
    const Eigen::Quaterniond carried = change.left * q * change.right;
    Eigen::Map<Eigen::Vector4d>(numbers, 4) = carried.coeffs();
    return;
  }
  Eigen::Map<Vector3d> vector(numbers);
  if (path == TrackPath::kTranslation)
    vector = is_value ? Vector3d(change.rest + change.linear * (vector - change.bind))
                      : Vector3d(change.linear * vector);
  else
    vector.setConstant(vector.cwiseQuotient(change.scale).mean());
}

}  // namespace

SkeletonFit fit_skeleton(const Skin& skin,
                         const AttributedMesh& source,
                         const AttributedMesh& target,
                         const SurfaceMap& map) {
  // Shares this close to none or all are rounding.
  constexpr double kShare = 1e-6;
  PairMoments whole;
  std::vector<PairMoments> around(skin.nodes.size());
  std::vector<double> share_of(skin.nodes.size(), 0.0);
  for (int p = 0; p < map.polygon_count(); ++p) {
    const Piece piece = piece_of(source.prepared.mesh, target.prepared.mesh, map, p);
    if (!(piece.area > 0)) continue;
    whole.add(piece.area, piece.source, piece.target);
    const std::vector<double> share = shares(skin, source, piece.on_source);
    for (std::size_t n = 0; n < share.size(); ++n) {
      share_of[n] += piece.area * share[n];
      if (share[n] > kShare && share[n] < 1 - kShare)
        around[n].add(piece.area * share[n] * (1 - share[n]), piece.source, piece.target);
    }
  }
  SkeletonFit fit;
  const Similarity all = whole.fit();
  for (std::size_t n = 0; n < skin.nodes.size(); ++n) {
    const int parent = skin.nodes[n].parent;
    const Similarity& above = parent < 0 ? all : fit.nodes[idx(parent)];
    fit.nodes.push_back(around[n].weight() > 0 ? around[n].fit(above) : above);
  }
  for (const int j : skin.joints)
    fit.with_parent += share_of[idx(j)] > 0 || skin.nodes[idx(j)].parent < 0 ? 0 : 1;
  return fit;
}

std::vector<SkeletonNode> carried_nodes(const std::vector<SkeletonNode>& nodes,
                                        const SkeletonFit& fit) {
  std::vector<Vector3d> places;
  double largest = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    places.emplace_back(fit.nodes[n](nodes[n].bind.topRightCorner<3, 1>()));
    largest = std::max(largest, places.back().cwiseAbs().maxCoeff());
  }
  // Whole multiples below 2^21 of one power of two: single precision holds them, their differences
  // and the sums of these exactly.
  constexpr int kBits = 20;
  const double step = largest > 0 ? std::exp2(std::ceil(std::log2(largest)) - kBits) : 1;
  std::vector<SkeletonNode> carried = nodes;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    places[n] = (places[n] / step).array().round() * step;
    const int parent = nodes[n].parent;
    carried[n].bind.setIdentity();
    carried[n].bind.topRightCorner<3, 1>() = places[n];
    carried[n].local.setIdentity();
    carried[n].local.topRightCorner<3, 1>() =
        parent < 0 ? places[n] : Vector3d(places[n] - places[idx(parent)]);
  }
  return carried;
}

std::vector<Track> carried_tracks(const std::vector<Track>& tracks,
                                  const std::vector<SkeletonNode>& from,
                                  const std::vector<SkeletonNode>& to,
                                  const SkeletonFit& fit) {
  std::vector<Track> carried = tracks;
  for (Track& track : carried) {
    if (track.path == TrackPath::kWeights) continue;
    const TrackChange change =
        change_of(from[idx(track.node)], to[idx(track.node)], fit.nodes[idx(track.node)]);
    const int groups = groups_of_key(track), middle = groups / 2;
    const int count = groups * static_cast<int>(track.times.size());
    for (int g = 0; g < count; ++g)
      apply(change, track.path, g % groups == middle, &track.values[idx(g * track.width)]);
  }
  return carried;
}

}  // namespace crosspatch
