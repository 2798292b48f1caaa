#pragma once

#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// The vertices that `is_free` (#V), by colour: no face of `F` (#F x 3) has two of one colour, so
/// that those of one can move at the same time. Coloured greedily by number.
std::vector<std::vector<int>> vertex_colours(const MatrixX3i& F, const std::vector<bool>& is_free);

}  // namespace crosspatch
