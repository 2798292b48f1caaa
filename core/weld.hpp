#pragma once

#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// Groups vertices at the same place: the result maps each row of `V` (#V x 3) to the smallest
/// index of its group. `distance` 0 groups identical positions only; otherwise vertices closer
/// than `distance` (same unit as V) are grouped, and so are chains of such. Vertices where
/// `weldable` is false stay alone. O(#V log #V) for well-spread points.
std::vector<int> weld(const MatrixX3d& V, const std::vector<bool>& weldable, double distance);

}  // namespace crosspatch
