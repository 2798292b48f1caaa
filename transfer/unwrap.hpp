#pragma once

#include <array>
#include <vector>

#include "transfer/source_attributes.hpp"

namespace crosspatch {

/// Where the faces of a mesh lie in its images: one corner after the other, 3 #F, in [0, 1]^2 with
/// v downwards as in glTF. No two faces overlap.
struct Unwrap {
  std::vector<Vector2d> uv;
};

/// The first UV set of the mesh's file, if images can be baked to it. kBadInput says why not: a
/// corner has no UV, one lies outside of the image, faces have no extent or overlap others by more
/// than a thousandth of the whole (looked at with 1024 texels a side).
Result<Unwrap> own_unwrap(const AttributedMesh& mesh);

/// The chart of each face, from 0 in the order of their first faces: faces whose images meet.
std::vector<int> charts_of(const TriangleMesh& mesh, const Unwrap& unwrap);

/// Share of the mesh's area on faces that are turned over against most of their chart, by area in
/// the image. They lie over their neighbours, which own_unwrap hardly sees where faces are seen
/// edge-on: hardly a texel belongs to them.
double folded_share(const TriangleMesh& mesh, const Unwrap& unwrap);

/// The corners of `face` in texels of an image with `size` texels a side.
std::array<Vector2d, 3> in_texels(const Unwrap& unwrap, int face, int size);

/// Whether the images of the two faces at half-edge h meet along it.
bool is_joined(const TriangleMesh& mesh, const Unwrap& unwrap, int h);

/// Share of the covered texels, of `size` a side, that more than one of `faces` covers (all faces
/// if empty).
double overlap(const Unwrap& unwrap, const std::vector<int>& faces, int size);

}  // namespace crosspatch
