#pragma once

#include <filesystem>

#include "core/file_bytes.hpp"
#include "transfer/motion.hpp"

namespace crosspatch {

/// What to read of how a file moves.
struct MotionParts {
  bool skin = false;
  bool morphs = false;
};

struct ReadMotion {
  Motion motion;            ///< vertices are those of read_gltf
  int tracks_left_out = 0;  ///< see ReadAnimations
};

/// Reads how the meshes of a glTF file move: skin, morph targets, and what of the animations moves
/// these.
///
/// kBadInput as read_gltf, read_skin, read_morphs and read_animations; so also when a part that is
/// asked for is not there.
Result<ReadMotion> read_gltf_motion(const std::filesystem::path& path,
                                    const MotionParts& parts,
                                    const ReadLimits& limits = {});

}  // namespace crosspatch
