#pragma once

#include "transfer/carry_motion.hpp"

namespace crosspatch {

/// Per vertex of the target, the turned and scaled frame that displacements there are carried with:
/// a turn times a scale. See carry_motion; vertices far from everything mapped have the identity.
std::vector<Eigen::Matrix3d> displacement_frames(const TriangleMesh& source,
                                                 const TriangleMesh& target,
                                                 const SurfaceMap& map);

}  // namespace crosspatch
