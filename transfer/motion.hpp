#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "core/types.hpp"

namespace crosspatch {

/// A joint, or a node above or between joints.
struct SkeletonNode {
  std::string name;
  int parent = -1;  ///< an earlier node, or -1
  /// The node's frame in the bind pose, to the coordinates of the mesh: for a joint the inverse of
  /// its inverse bind matrix.
  Eigen::Matrix4d bind = Eigen::Matrix4d::Identity();
  /// The same to the parent's frame; tracks move it from there.
  Eigen::Matrix4d local = Eigen::Matrix4d::Identity();
};

/// How vertices follow joints: v moves to sum_j w_j M_j v, M_j being what joint j's frame does from
/// the bind pose on.
///
/// Invariants: (1) parents come before their children; (2) joints index `nodes`, each once; (3)
/// frames are affine, have an inverse and do not mirror, and a node's is its parent's times its
/// own local one; (4) weights (#vertices x #joints) are
/// not negative; a row without any belongs to a vertex that follows no joint.
struct Skin {
  std::vector<SkeletonNode> nodes;
  std::vector<int> joints;
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights;
};

/// A shape that a mesh can be blended with: vertices move by weight times displacement.
struct MorphTarget {
  std::string name;
  double weight = 0;  ///< at rest
  MatrixX3d displacements;
  MatrixX3d normal_displacements;  ///< empty, or one a vertex
};

enum class TrackPath { kTranslation, kRotation, kScale, kWeights };

enum class Interpolation { kLinear, kStep, kCubicSpline };

/// One moving property, as glTF's animation samplers have it.
///
/// `values` has `width` numbers a key: 3, a quaternion x y z w, or one weight a morph target; with
/// kCubicSpline a key has three such groups: in-tangent, value, out-tangent.
struct Track {
  int node = -1;  ///< of the skeleton; -1: the weights of the morph targets
  TrackPath path = TrackPath::kRotation;
  Interpolation interpolation = Interpolation::kLinear;
  int width = 4;
  std::vector<double> times;  ///< seconds, ascending, not negative
  std::vector<double> values;
};

struct Animation {
  std::string name;
  std::vector<Track> tracks;
};

/// How a mesh moves. Rotations and so on in tracks are a node's relative to its parent.
struct Motion {
  std::optional<Skin> skin;
  std::vector<MorphTarget> morphs;
  std::vector<Animation> animations;
};

/// A transform as glTF's nodes give it, first scaled, then turned, then moved.
struct Placement {
  Vector3d translation;
  Eigen::Quaterniond rotation;
  Vector3d scale;
};

/// The parts of an affine transform that does not mirror; shear is lost.
Placement placement(const Eigen::Matrix4d& transform);

/// Checks the invariants of the parts, for a mesh of that many vertices; kInternal.
Status validate(const Motion& motion, int vertices);

/// Groups of `width` numbers that a key of the track has.
inline int groups_of_key(const Track& track) {
  return track.interpolation == Interpolation::kCubicSpline ? 3 : 1;
}

}  // namespace crosspatch
