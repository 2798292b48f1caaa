#pragma once

#include <vector>

#include "core/file_bytes.hpp"
#include "transfer/gltf_morphs.hpp"
#include "transfer/gltf_skin.hpp"

namespace crosspatch {

struct ReadAnimations {
  std::vector<Animation> animations;
  int tracks_left_out = 0;  ///< they move what is neither of the skeleton nor the targets' weights
};

/// The animations of `model`, as far as they move the skeleton of `skin` or the weights of
/// `morphs` (null: there is none); those that move neither are left out. Where the skeleton's pose
/// at rest is not its bind pose, an animation that leaves a part of a node at rest gets a track
/// that holds it there, since we begin with the bind pose.
///
/// kBadInput: an unknown interpolation, times that are negative, not finite or not ascending,
/// values of another number or type than the keys ask for or not finite, a rotation of length 0,
/// two tracks for one thing, more than kMostKeyNumbers.
Result<ReadAnimations> read_animations(const tinygltf::Model& model,
                                       const ReadSkin* skin,
                                       const ReadMorphs* morphs,
                                       const ReadLimits& limits);

/// Ours: 160 MB. 200 nodes for an hour at 30 keys a second are 75 M: that is not read.
constexpr std::int64_t kMostKeyNumbers = 20'000'000;

}  // namespace crosspatch
