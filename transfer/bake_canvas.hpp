#pragma once

#include <cstdint>
#include <vector>

#include "transfer/unwrap.hpp"

namespace crosspatch {

enum TexelState : std::uint8_t {
  kEmpty,
  kFilled,     ///< painted through the map
  kContinued,  ///< in a gutter, painted with what lies across the seam
};

/// A square image in the making.
struct BakeCanvas {
  int size = 0;
  int channels = 4;  ///< 3: there is no alpha
  /// Linear, in 65535ths; channels * size^2, and one more: texels are read four values at once.
  std::vector<std::uint16_t> values;
  std::vector<std::uint8_t> state;  ///< TexelState, size^2

  [[nodiscard]] std::size_t texel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
           static_cast<std::size_t>(x);
  }
};

/// An empty canvas. `channels`: 3 or 4.
BakeCanvas make_canvas(int size, int channels);

/// Paints empty texels up to `reach` texels from a seam, the nearest, with what lies across it: the
/// faces there are unfolded into the plane of the seam's face, and the canvas is read where it was
/// painted. So filtering sees the same on both sides of the seam. Not beside faces that are seen
/// edge-on, of which a texel is sixteen times as long on the surface as the mean one.
void continue_across_seams(BakeCanvas& canvas,
                           const TriangleMesh& mesh,
                           const Unwrap& unwrap,
                           int reach);

/// Fills the texels that are still empty smoothly from all others (Gortler et al. 1996, "The
/// lumigraph", Sec. 3.4). A canvas without any painted texel stays as it is.
void push_pull(BakeCanvas& canvas);

}  // namespace crosspatch
