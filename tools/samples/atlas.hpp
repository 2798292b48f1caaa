#pragma once

#include <vector>

#include "tools/samples/creature.hpp"

namespace crosspatch {

/// A square texture layout. `pixel` (3 #F x 2) are corner positions in pixels from the upper left;
/// every triangle belongs to one chart, charts keep `kGutter` pixels from each other and the rim.
struct Atlas {
  int size = 0;
  MatrixX2d pixel;
  std::vector<int> chart;  ///< per face
};

constexpr int kGutter = 3;

/// Lays the skin out: each part is cut into a left and a right half (by the sign of the normal's
/// x), each connected piece is seen along x, and the pieces are packed row by row into a square of
/// `size` pixels at one scale, the largest that fits.
Atlas make_atlas(const Creature& creature, const TriangleMesh& mesh, int size);

}  // namespace crosspatch
