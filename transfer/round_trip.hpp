#pragma once

#include "transfer/bake.hpp"
#include "transfer/image_similarity.hpp"

namespace crosspatch {

struct RoundTrip {
  ImageSimilarity similarity;
  int size = 0;        ///< texels a side that were compared
  double covered = 0;  ///< share of the source's area that was there and back
};

/// Bakes the base colour of `baked`, which bake_texture made of the other arguments, back over the
/// source's own texture coordinates, and compares it with what the source looks like there: how
/// much of the texture was lost on the way. Texels are the source image's, at most kMostTexels a
/// side.
///
/// kBadInput when the source's texture coordinates are no unwrap (see own_unwrap): places that
/// share texels cannot be compared texel by texel. Cost: that of two bakes of that size.
Result<RoundTrip> round_trip(const AttributedMesh& source,
                             const AttributedMesh& target,
                             const SurfaceMap& map,
                             const TexturedMesh& baked);

}  // namespace crosspatch
