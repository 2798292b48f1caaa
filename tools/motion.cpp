#include "tools/motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "transfer/carry_motion.hpp"

namespace crosspatch {
namespace {

std::string counted(std::size_t n, const char* thing) {
  return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s");
}

}  // namespace

Result<SourceMotion> read_motion(const std::string& path,
                                 const InputMesh& source,
                                 const MotionParts& parts) {
  const PolygonSoup& soup = source.soup;
  if (parts.skin && !soup.skinned)
    return fail(ErrorCode::kBadInput, fmt::format("{}: has no skin, which --skin carries", path));
  if (parts.morphs && soup.morph_targets == 0)
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: has no morph targets, which --morphs carries", path));
  SourceMotion motion;
  if (parts.skin || parts.morphs) {
    Result<ReadMotion> read = read_gltf_motion(path, parts);
    if (!read) return tl::unexpected(with_path(path, read.error()));
    motion.read = std::move(*read);
  }
  std::vector<std::string> left;
  if (soup.skinned && !parts.skin) left.emplace_back("a skin (--skin)");
  if (soup.morph_targets > 0 && !parts.morphs)
    left.push_back(counted(static_cast<std::size_t>(soup.morph_targets), "morph target") +
                   " (--morphs)");
  const std::size_t animations =
      static_cast<std::size_t>(soup.animations) - motion.read.motion.animations.size();
  if (animations > 0) left.push_back(counted(animations, "animation"));
  motion.left = fmt::format("{}", fmt::join(left, ", "));
  return motion;
}

Result<MotionOutcome> move_mesh(const SourceMotion& source,
                                const PairRun& run,
                                TexturedMesh& mesh) {
  MotionOutcome outcome;
  if (!source.left.empty())
    outcome.warnings.push_back("the source has what is not carried: " + source.left);
  const Motion& motion = source.read.motion;
  if (!motion.skin && motion.morphs.empty()) return outcome;
  if (source.read.tracks_left_out > 0)
    outcome.warnings.push_back(
        counted(static_cast<std::size_t>(source.read.tracks_left_out), "animation track") +
        " that moves nothing of the mesh is left out");
  Result<CarriedMotion> carried = carry_motion(motion,
                                               {run.source.prepared, run.source.soup},
                                               {run.target.prepared, run.target.soup},
                                               run.matched.result.map,
                                               mesh);
  if (!carried) return tl::unexpected(carried.error());
  mesh.motion = std::move(carried->motion);
  outcome.figures["motion_unmapped_positions"] = carried->unmapped_positions;
  if (motion.skin) {
    outcome.figures["skin_joints"] = static_cast<double>(motion.skin->joints.size());
    outcome.figures["skin_joints_with_parent"] = carried->joints_with_parent;
    outcome.figures["skin_dropped_weight"] = carried->dropped_weight;
    outcome.summary += ", " + counted(motion.skin->joints.size(), "joint");
  }
  if (!motion.morphs.empty()) {
    outcome.figures["morph_targets"] = static_cast<double>(motion.morphs.size());
    outcome.summary += ", " + counted(motion.morphs.size(), "morph target");
  }
  outcome.figures["animations"] = static_cast<double>(motion.animations.size());
  if (!motion.animations.empty())
    outcome.summary += ", " + counted(motion.animations.size(), "animation");
  if (carried->unmapped_positions > 0)
    outcome.warnings.push_back(
        fmt::format("{} without a counterpart that moves go with the nearest that has one",
                    counted(static_cast<std::size_t>(carried->unmapped_positions), "position")));
  return outcome;
}

}  // namespace crosspatch
