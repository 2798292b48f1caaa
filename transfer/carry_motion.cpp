#include "transfer/carry_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>

#include "core/index.hpp"
#include "transfer/carry_morphs.hpp"
#include "transfer/carry_skin.hpp"
#include "transfer/fit_similarity.hpp"

namespace crosspatch {
namespace {

using Weights = std::vector<std::pair<int, double>>;  ///< joint, weight

/// Where the positions of a mesh come from.
struct Place {
  std::array<int, 3> vertex{-1, -1, -1};  ///< of the source's file
  Vector3d bary = Vector3d::Zero();
  SurfacePoint target;
};

std::vector<Place> places_of(const AttributedMesh& source,
                             const SurfaceMap& map,
                             const std::vector<int>& map_point) {
  std::vector<Place> places(map_point.size());
  for (std::size_t row = 0; row < places.size(); ++row) {
    const int q = map_point[row];
    if (q < 0 || !map.source[idx(q)].valid()) continue;
    const SurfacePoint& p = map.source[idx(q)];
    for (int k = 0; k < 3; ++k)
      places[row].vertex[idx(k)] =
          source.soup
              .corner_vertex[idx(source.prepared.numbering.soup_corner[idx(3 * p.face + k)])];
    places[row].bary = p.bary.cwiseMax(0.0);
    places[row].bary /= places[row].bary.sum();
    places[row].target = map.target[idx(q)];
  }
  return places;
}

Weights weights_at(const Skin& skin, const Place& place) {
  Weights weights;
  for (int k = 0; k < 3; ++k) {
    if (!(place.bary[k] > 0)) continue;
    const int vertex = place.vertex[idx(k)];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, vertex); w;
         ++w)
      weights.emplace_back(static_cast<int>(w.col()), place.bary[k] * w.value());
  }
  std::sort(weights.begin(), weights.end());
  Weights merged;
  for (const auto& [joint, weight] : weights) {
    if (merged.empty() || merged.back().first != joint) merged.emplace_back(joint, 0);
    merged.back().second += weight;
  }
  return merged;
}

/// The four largest as fractions of 2^20 with sum 1; what rounding leaves goes to the largest.
/// Returns the share that was dropped.
double keep_largest(Weights& weights) {
  constexpr std::size_t kMost = 4;
  constexpr double kUnits = 1 << 20;
  double kept = 0, dropped = 0;
  std::sort(weights.begin(), weights.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  for (std::size_t i = kMost; i < weights.size(); ++i) dropped += weights[i].second;
  weights.resize(std::min(weights.size(), kMost));
  for (const auto& entry : weights) kept += entry.second;
  double rest = 1;
  for (auto& entry : weights)
    rest -= entry.second = std::floor(entry.second / kept * kUnits) / kUnits;
  weights.front().second += rest;
  while (weights.back().second == 0) weights.pop_back();
  std::sort(weights.begin(), weights.end());
  return dropped / (kept + dropped);
}

/// Per row the row whose values it takes: itself where `has`, else the nearest along edges; -1
/// where there is none.
std::vector<int> givers(const TexturedMesh& mesh, const std::vector<bool>& has) {
  std::vector<std::vector<int>> around(has.size());
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles(t, k), b = mesh.triangles(t, (k + 1) % 3);
      around[idx(a)].push_back(b);
      around[idx(b)].push_back(a);
    }
  std::vector<int> giver(has.size(), -1);
  std::deque<int> queue;
  for (std::size_t row = 0; row < has.size(); ++row)
    if (has[row]) {
      giver[row] = static_cast<int>(row);
      queue.push_back(static_cast<int>(row));
    }
  for (; !queue.empty(); queue.pop_front())
    for (const int next : around[idx(queue.front())])
      if (giver[idx(next)] < 0) {
        giver[idx(next)] = giver[idx(queue.front())];
        queue.push_back(next);
      }
  return giver;
}

Skin carried_skin(const Skin& skin,
                  const SkeletonFit& fit,
                  const std::vector<Place>& places,
                  const TexturedMesh& mesh,
                  CarriedMotion& result) {
  std::vector<Weights> weights(places.size());
  std::vector<bool> has(places.size());
  for (std::size_t row = 0; row < places.size(); ++row) {
    if (places[row].target.valid()) weights[row] = weights_at(skin, places[row]);
    has[row] = !weights[row].empty();
    if (has[row])
      result.dropped_weight = std::max(result.dropped_weight, keep_largest(weights[row]));
  }
  result.unmapped_positions = std::max(result.unmapped_positions,
                                       static_cast<int>(std::count(has.begin(), has.end(), false)));
  const std::vector<int> giver = givers(mesh, has);
  const Weights first_joint{{0, 1.0}};
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < places.size(); ++row)
    for (const auto& [joint, weight] : giver[row] < 0 ? first_joint : weights[idx(giver[row])])
      entries.emplace_back(static_cast<int>(row), joint, weight);
  Skin carried;
  carried.nodes = carried_nodes(skin.nodes, fit);
  carried.joints = skin.joints;
  carried.weights.resize(static_cast<Eigen::Index>(places.size()), skin.weights.cols());
  carried.weights.setFromTriplets(entries.begin(), entries.end());
  return carried;
}

/// The vectors at the vertices of the source's file, interpolated and put through the frames.
MatrixX3d carried_vectors(const MatrixX3d& vectors,
                          const std::vector<Place>& places,
                          const std::vector<int>& giver,
                          const std::vector<Eigen::Matrix3d>& frame_at) {
  MatrixX3d carried = MatrixX3d::Zero(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t row = 0; row < places.size(); ++row) {
    if (giver[row] < 0) continue;
    const Place& place = places[idx(giver[row])];
    Vector3d d = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) d += place.bary[k] * vectors.row(place.vertex[idx(k)]).transpose();
    carried.row(static_cast<Eigen::Index>(row)) = (frame_at[idx(giver[row])] * d).transpose();
  }
  return carried;
}

void carry_morphs(const std::vector<MorphTarget>& morphs,
                  const AttributedMesh& source,
                  const AttributedMesh& target,
                  const SurfaceMap& map,
                  const std::vector<Place>& places,
                  const TexturedMesh& mesh,
                  CarriedMotion& result) {
  const TriangleMesh& surface = target.prepared.mesh;
  const std::vector<Eigen::Matrix3d> at_vertex =
      displacement_frames(source.prepared.mesh, surface, map);
  std::vector<bool> has;
  std::vector<Eigen::Matrix3d> frames, turns;
  for (const Place& place : places) {
    has.push_back(place.target.valid());
    Eigen::Matrix3d frame = Eigen::Matrix3d::Zero();
    if (has.back())
      for (int k = 0; k < 3; ++k)
        frame += place.target.bary[k] * at_vertex[idx(surface.F(place.target.face, k))];
    frames.push_back(frame);
    turns.push_back(has.back() ? nearest_turn(frame) : frame);
  }
  result.unmapped_positions = std::max(result.unmapped_positions,
                                       static_cast<int>(std::count(has.begin(), has.end(), false)));
  const std::vector<int> giver = givers(mesh, has);
  for (const MorphTarget& morph : morphs) {
    MorphTarget carried{morph.name, morph.weight, {}, {}};
    carried.displacements = carried_vectors(morph.displacements, places, giver, frames);
    if (morph.normal_displacements.rows() > 0)
      carried.normal_displacements =
          carried_vectors(morph.normal_displacements, places, giver, turns);
    result.motion.morphs.push_back(std::move(carried));
  }
}

}  // namespace

Result<CarriedMotion> carry_motion(const Motion& motion,
                                   const AttributedMesh& source,
                                   const AttributedMesh& target,
                                   const SurfaceMap& map,
                                   const TexturedMesh& mesh) {
  if (Status s = validate(motion, static_cast<int>(source.soup.positions.rows())); !s)
    return tl::unexpected(s.error());
  if (mesh.map_point.size() != idx(mesh.positions.rows()))
    return fail(ErrorCode::kInternal,
                fmt::format("motion: {} points of the map for {} positions",
                            mesh.map_point.size(),
                            mesh.positions.rows()));
  const std::vector<Place> places = places_of(source, map, mesh.map_point);
  CarriedMotion result;
  result.motion.animations = motion.animations;
  if (motion.skin) {
    const SkeletonFit fit = fit_skeleton(*motion.skin, source, target, map);
    result.joints_with_parent = fit.with_parent;
    result.motion.skin = carried_skin(*motion.skin, fit, places, mesh, result);
    for (Animation& animation : result.motion.animations)
      animation.tracks =
          carried_tracks(animation.tracks, motion.skin->nodes, result.motion.skin->nodes, fit);
  }
  if (!motion.morphs.empty())
    carry_morphs(motion.morphs, source, target, map, places, mesh, result);
  return result;
}

}  // namespace crosspatch
