#include "transfer/gltf_motion.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <Eigen/LU>
#include <new>

#include "transfer/gltf_animations.hpp"
#include "transfer/gltf_load.hpp"

namespace crosspatch {
namespace {

Result<ReadMotion> read(const std::filesystem::path& path,
                        const MotionParts& parts,
                        const ReadLimits& limits) {
  const auto bytes = read_file_bytes(path, limits.max_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  tinygltf::Model model;
  std::map<int, std::vector<unsigned char>> images;
  std::vector<std::string> notes;
  if (Status s = load_gltf({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                           path.parent_path(),
                           limits,
                           model,
                           images,
                           notes);
      !s)
    return tl::unexpected(s.error());
  const auto instances = mesh_instances(model);
  if (!instances) return tl::unexpected(instances.error());
  if (instances->empty()) return fail(ErrorCode::kBadInput, "the scene shows no mesh");
  std::optional<ReadSkin> skin;
  std::optional<ReadMorphs> morphs;
  if (parts.skin) {
    auto read = read_skin(model, *instances, limits);
    if (!read) return tl::unexpected(read.error());
    skin = std::move(*read);
  }
  if (parts.morphs) {
    auto read = read_morphs(model, *instances, limits);
    if (!read) return tl::unexpected(read.error());
    morphs = std::move(*read);
  }
  auto animations =
      read_animations(model, skin ? &*skin : nullptr, morphs ? &*morphs : nullptr, limits);
  if (!animations) return tl::unexpected(animations.error());
  ReadMotion out;
  if (skin) out.motion.skin = std::move(skin->skin);
  if (morphs) out.motion.morphs = std::move(morphs->morphs);
  out.motion.animations = std::move(animations->animations);
  out.tracks_left_out = animations->tracks_left_out;
  return out;
}

}  // namespace

Result<ReadMotion> read_gltf_motion(const std::filesystem::path& path,
                                    const MotionParts& parts,
                                    const ReadLimits& limits) {
  const std::string name = in_quotes(path.filename().string());
  try {
    Result<ReadMotion> motion = read(path, parts, limits);
    if (!motion)
      return fail(motion.error().code, fmt::format("file {}: {}", name, motion.error().message));
    return motion;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kInternal, fmt::format("file {}: not enough memory", name));
  } catch (const std::exception& e) {
    return fail(ErrorCode::kBadInput, fmt::format("file {}: {}", name, e.what()));
  }
}

}  // namespace crosspatch
