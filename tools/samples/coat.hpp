#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/samples/atlas.hpp"

namespace crosspatch {

/// Three 8-bit sRGB channels a pixel, rows from the top.
struct CoatImage {
  int size = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 size^2
};

/// Colours of one creature's coat, sRGB in [0, 255].
struct CoatColors {
  Vector3d back, belly, stripe, left_spot, right_spot, sock_front, sock_hind, tail_tip;
};

CoatColors lira_colors();
CoatColors bodo_colors();

/// Paints the coat into the atlas by place in space: a lighter belly, stripes across the body,
/// round spots on the left and square ones on the right, socks of one colour in front and another
/// behind, eyes, nose, ears and tail tip. So a picture of a transferred coat shows which place went
/// where.
CoatImage paint_coat(const Creature& creature,
                     const CoatColors& colors,
                     const TriangleMesh& mesh,
                     const Atlas& atlas);

}  // namespace crosspatch
