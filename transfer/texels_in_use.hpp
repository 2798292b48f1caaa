#pragma once

#include <array>
#include <vector>

#include "transfer/source_look.hpp"

namespace crosspatch {

/// Which texels of an image show something of the mesh: true where the centre lies inside of a
/// triangle whose material has the image in this channel; width * height, rows from the
/// top. A triangle without any centre, in an island smaller than texels, keeps the one at its
/// middle. Empty, for all, where a triangle leaves the image: a pattern that is repeated has no
/// outside.
std::vector<bool> texels_in_use(const TexturedMesh& mesh,
                                Channel channel,
                                int image,
                                std::array<int, 2> size);

}  // namespace crosspatch
