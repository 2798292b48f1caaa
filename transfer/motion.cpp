#include "transfer/motion.hpp"

#include <fmt/format.h>

#include <Eigen/LU>

#include "core/index.hpp"

namespace crosspatch {
namespace {

Status broken(const std::string& what) {
  return fail(ErrorCode::kInternal, "motion: " + what);
}

bool is_frame(const Eigen::Matrix4d& m) {
  return m.allFinite() && m.topLeftCorner<3, 3>().determinant() > 0 &&
         m.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
}

Status check_skin(const Skin& skin, int vertices) {
  const int nodes = static_cast<int>(skin.nodes.size());
  for (int n = 0; n < nodes; ++n) {
    const SkeletonNode& node = skin.nodes[idx(n)];
    if (node.parent < -1 || node.parent >= n)
      return broken(fmt::format("node {} has parent {}", n, node.parent));
    const Eigen::Matrix4d& outer = node.parent < 0 ? node.bind : skin.nodes[idx(node.parent)].bind;
    if (!is_frame(node.bind) || !is_frame(node.local) ||
        (node.parent >= 0 && !node.bind.isApprox(outer * node.local, 1e-6)))
      return broken(fmt::format("the bind frame of node {} is none", n));
  }
  std::vector<bool> seen(idx(nodes), false);
  for (const int j : skin.joints) {
    if (j < 0 || j >= nodes || seen[idx(j)]) return broken(fmt::format("joint {} of {}", j, nodes));
    seen[idx(j)] = true;
  }
  if (skin.joints.empty()) return broken("a skin without joints");
  if (skin.weights.rows() != vertices ||
      skin.weights.cols() != static_cast<Eigen::Index>(skin.joints.size()))
    return broken(fmt::format("weights are {} x {} for {} vertices and {} joints",
                              skin.weights.rows(),
                              skin.weights.cols(),
                              vertices,
                              skin.joints.size()));
  for (int v = 0; v < vertices; ++v)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, v); w; ++w)
      if (!std::isfinite(w.value()) || w.value() < 0)
        return broken(fmt::format("vertex {} has weight {}", v, w.value()));
  return {};
}

Status check_track(const Track& track, const Motion& motion) {
  const int nodes = motion.skin ? static_cast<int>(motion.skin->nodes.size()) : 0;
  const bool weights = track.path == TrackPath::kWeights;
  if (weights ? track.node != -1 : track.node < 0 || track.node >= nodes)
    return broken(fmt::format("a track moves node {} of {}", track.node, nodes));
  const std::size_t width = weights                              ? motion.morphs.size()
                            : track.path == TrackPath::kRotation ? 4
                                                                 : 3;
  if (idx(track.width) != width || track.times.empty() ||
      track.values.size() != track.times.size() * width * idx(groups_of_key(track)))
    return broken(fmt::format("a track has {} numbers of {} for {} keys",
                              track.values.size(),
                              track.width,
                              track.times.size()));
  return {};
}

}  // namespace

Placement placement(const Eigen::Matrix4d& transform) {
  const Eigen::Affine3d affine(transform);
  return {affine.translation(),
          Eigen::Quaterniond(affine.rotation()),
          affine.linear().colwise().norm().transpose()};
}

Status validate(const Motion& motion, int vertices) {
  if (motion.skin)
    if (Status s = check_skin(*motion.skin, vertices); !s) return s;
  for (const MorphTarget& morph : motion.morphs) {
    if (morph.displacements.rows() != vertices || !morph.displacements.allFinite())
      return broken(fmt::format(
          "a morph target moves {} of {} vertices", morph.displacements.rows(), vertices));
    const Eigen::Index normals = morph.normal_displacements.rows();
    if ((normals != 0 && normals != vertices) || !morph.normal_displacements.allFinite())
      return broken(fmt::format("a morph target turns {} of {} normals", normals, vertices));
  }
  for (const Animation& animation : motion.animations)
    for (const Track& track : animation.tracks)
      if (Status s = check_track(track, motion); !s) return s;
  return {};
}

}  // namespace crosspatch
