#pragma once

#include <map>

#include "core/soup.hpp"

namespace tinygltf {
class Model;
}

namespace crosspatch {

/// The materials of `model` with their samplers and texture transforms. `image_of` leads from the
/// file's images to those of the soup; images that could not be read are not in it.
std::vector<Material> gltf_materials(const tinygltf::Model& model,
                                     const std::map<int, int>& image_of);

}  // namespace crosspatch
