#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/pipeline.hpp"
#include "transfer/gltf_motion.hpp"
#include "transfer/textured_mesh.hpp"

namespace crosspatch {

/// What of a source's motion was asked for, and what it has beside that.
struct SourceMotion {
  ReadMotion read;
  std::string left;  ///< "a skin and 2 animations", or ""
};

/// Reads the parts that are asked for. kBadInput with the path: the source lacks one, or it is not
/// sound.
Result<SourceMotion> read_motion(const std::string& path,
                                 const InputMesh& source,
                                 const MotionParts& parts);

struct MotionOutcome {
  std::map<std::string, double> figures;
  std::string summary;  ///< to follow another one; empty if nothing moves
  std::vector<std::string> warnings;
};

/// Gives the carried motion to the mesh that was made of the run's target.
Result<MotionOutcome> move_mesh(const SourceMotion& motion, const PairRun& run, TexturedMesh& mesh);

}  // namespace crosspatch
