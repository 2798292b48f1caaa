#include "transfer/gltf_animations.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/index.hpp"
#include "transfer/gltf_accessor.hpp"

namespace crosspatch {
namespace {

std::optional<TrackPath> path_named(const std::string& name) {
  if (name == "translation") return TrackPath::kTranslation;
  if (name == "rotation") return TrackPath::kRotation;
  if (name == "scale") return TrackPath::kScale;
  if (name == "weights") return TrackPath::kWeights;
  return std::nullopt;
}

std::optional<Interpolation> interpolation_named(const std::string& name) {
  if (name.empty() || name == "LINEAR") return Interpolation::kLinear;
  if (name == "STEP") return Interpolation::kStep;
  if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
  return std::nullopt;
}

Status bad(std::string message) {
  return fail(ErrorCode::kBadInput, std::move(message));
}

class AnimationReader {
 public:
  AnimationReader(const tinygltf::Model& model,
                  const ReadSkin* skin,
                  const ReadMorphs* morphs,
                  const ReadLimits& limits)
      : model_(model), skin_(skin), morphs_(morphs), limits_(limits) {}

  Result<ReadAnimations> read() {
    for (std::size_t a = 0; a < model_.animations.size(); ++a) {
      Animation animation;
      animation.name = model_.animations[a].name;
      if (Status s = add_tracks(model_.animations[a], animation); !s)
        return fail(s.error().code, fmt::format("animation {}: {}", a, s.error().message));
      if (!animation.tracks.empty()) out_.animations.push_back(std::move(animation));
    }
    return std::move(out_);
  }

 private:
  /// The skeleton's node or -1 for weights, if the channel moves anything of ours.
  std::optional<int> moved(const tinygltf::AnimationChannel& channel, TrackPath path) const {
    if (channel.target_node < 0) return std::nullopt;
    if (path == TrackPath::kWeights) {
      // Meshes with targets have the same ones; the first gives the tracks.
      const bool ours = morphs_ != nullptr && morphs_->file_nodes.front() == channel.target_node;
      return ours ? std::optional(-1) : std::nullopt;
    }
    if (skin_ == nullptr) return std::nullopt;
    const int node = skin_->skeleton_node[idx(channel.target_node)];
    return node >= 0 ? std::optional(node) : std::nullopt;
  }

  Status add_tracks(const tinygltf::Animation& from, Animation& to) {
    std::set<std::pair<int, TrackPath>> seen;
    for (std::size_t c = 0; c < from.channels.size(); ++c) {
      const tinygltf::AnimationChannel& channel = from.channels[c];
      const auto path = path_named(channel.target_path);
      const auto node = path ? moved(channel, *path) : std::nullopt;
      if (!node) {
        ++out_.tracks_left_out;
        continue;
      }
      if (!seen.insert({*node, *path}).second)
        return bad(fmt::format("channel {}: another moves the same", c));
      Track track;
      track.node = *node;
      track.path = *path;
      track.width = *path == TrackPath::kRotation  ? 4
                    : *path == TrackPath::kWeights ? static_cast<int>(morphs_->morphs.size())
                                                   : 3;
      if (Status s = read_keys(from.samplers[idx(channel.sampler)], track); !s)
        return fail(s.error().code, fmt::format("channel {}: {}", c, s.error().message));
      to.tracks.push_back(std::move(track));
    }
    if (skin_ != nullptr &&
        std::any_of(seen.begin(), seen.end(), [](const auto& moved) { return moved.first >= 0; }))
      hold_rest(seen, to);
    return {};
  }

  Status read_keys(const tinygltf::AnimationSampler& sampler, Track& track) {
    const auto interpolation = interpolation_named(sampler.interpolation);
    if (!interpolation) return bad("the interpolation is none of glTF's");
    track.interpolation = *interpolation;
    auto times = read_accessor(model_, sampler.input, limits_.max_vertices);
    if (!times) return tl::unexpected(times.error());
    auto values = read_accessor(model_, sampler.output, limits_.max_vertices);
    if (!values) return tl::unexpected(values.error());
    const bool weights = track.path == TrackPath::kWeights;
    const std::size_t keys = times->count();
    const std::size_t wanted = keys * idx(track.width) * idx(groups_of_key(track));
    if (keys == 0 || times->components != 1 || values->components != (weights ? 1 : track.width) ||
        values->values.size() != wanted)
      return bad(fmt::format("{} numbers in groups of {} for {} keys that need {}",
                             values->values.size(),
                             values->components,
                             keys,
                             wanted));
    numbers_ += static_cast<std::int64_t>(wanted + keys);
    if (numbers_ > kMostKeyNumbers)
      return bad(fmt::format("more than {} numbers", kMostKeyNumbers));
    for (std::size_t i = 0; i < keys; ++i)
      if (!std::isfinite(times->values[i]) ||
          !(times->values[i] >= (i == 0 ? 0 : times->values[i - 1])) ||
          (i > 0 && times->values[i] == times->values[i - 1]))
        return bad(fmt::format("the time of key {} is {}", i, times->values[i]));
    for (const double v : values->values)
      if (!std::isfinite(v)) return bad(fmt::format("a key has the value {}", v));
    track.times = std::move(times->values);
    track.values = std::move(values->values);
    return track.path == TrackPath::kRotation ? normalize(track) : Status{};
  }

  /// Rotations get length 1; tangents keep their ratio to it.
  static Status normalize(Track& track) {
    constexpr double kNoRotation = 1e-6;
    const std::size_t groups = idx(groups_of_key(track));
    for (std::size_t key = 0; key < track.times.size(); ++key) {
      double* group = &track.values[4 * groups * key];
      Eigen::Map<Eigen::Vector4d> value(group + 4 * (groups / 2));
      const double length = value.norm();
      if (!(length > kNoRotation))
        return bad(fmt::format("the rotation of key {} has length {}", key, length));
      for (std::size_t i = 0; i < 4 * groups; ++i) group[i] /= length;
    }
    return {};
  }

  void hold_rest(const std::set<std::pair<int, TrackPath>>& seen, Animation& animation) {
    // What exporters' rounding to single precision leaves, and no eye sees.
    constexpr double kSame = 1e-3;
    const auto hold = [&](std::size_t n, TrackPath path, std::vector<double> values) {
      if (seen.count({static_cast<int>(n), path}) > 0) return;
      animation.tracks.push_back({static_cast<int>(n),
                                  path,
                                  Interpolation::kStep,
                                  static_cast<int>(values.size()),
                                  {0},
                                  std::move(values)});
    };
    for (std::size_t n = 0; n < skin_->skin.nodes.size(); ++n) {
      const Placement bind = placement(skin_->skin.nodes[n].local);
      const Eigen::Matrix4d local = local_transform(model_.nodes[idx(skin_->file_node[n])]);
      const Placement rest = placement(local);
      const Vector3d& t = rest.translation;
      const Eigen::Quaterniond& q = rest.rotation;
      const Vector3d& s = rest.scale;
      if ((t - bind.translation).norm() > kSame * (t.norm() + bind.translation.norm()))
        hold(n, TrackPath::kTranslation, {t[0], t[1], t[2]});
      if (q.angularDistance(bind.rotation) > kSame)
        hold(n, TrackPath::kRotation, {q.x(), q.y(), q.z(), q.w()});
      if ((s - bind.scale).norm() > kSame * bind.scale.norm())
        hold(n, TrackPath::kScale, {s[0], s[1], s[2]});
    }
  }

  const tinygltf::Model& model_;
  const ReadSkin* skin_;
  const ReadMorphs* morphs_;
  const ReadLimits& limits_;
  std::int64_t numbers_ = 0;
  ReadAnimations out_;
};

}  // namespace

Result<ReadAnimations> read_animations(const tinygltf::Model& model,
                                       const ReadSkin* skin,
                                       const ReadMorphs* morphs,
                                       const ReadLimits& limits) {
  return AnimationReader(model, skin, morphs, limits).read();
}

}  // namespace crosspatch
