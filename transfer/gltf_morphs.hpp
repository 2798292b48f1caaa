#pragma once

#include <vector>

#include "core/file_bytes.hpp"
#include "transfer/gltf_nodes.hpp"
#include "transfer/motion.hpp"

namespace crosspatch {

struct ReadMorphs {
  std::vector<MorphTarget> morphs;
  std::vector<int> file_nodes;  ///< whose weights they follow
};

/// The morph targets of the shown meshes, vertices numbered as read_gltf does, in the coordinates
/// of the first mesh; vertices of meshes without them stay. Displaced tangents are left out.
///
/// kBadInput: no targets; meshes or primitives whose targets differ in number or names, displaced
/// places or normals of another number than the places or not finite, weights of another number
/// than the targets, more than `kMostDisplacements` numbers of targets times vertices.
Result<ReadMorphs> read_morphs(const tinygltf::Model& model,
                               const std::vector<MeshInstance>& instances,
                               const ReadLimits& limits);

/// Ours: a gigabyte. 500 targets of 80,000 vertices fit.
constexpr std::int64_t kMostDisplacements = 40'000'000;

}  // namespace crosspatch
