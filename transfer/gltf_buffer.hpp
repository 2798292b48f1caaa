#pragma once

#include <array>
#include <vector>

namespace tinygltf {
class Model;
}

namespace crosspatch {

/// Appends bytes to the one buffer of `model`, aligned to four, and returns their view. `target` 0:
/// neither for vertices nor for indices.
int add_view(tinygltf::Model& model, const void* data, std::size_t size, int target);

int add_accessor(tinygltf::Model& model, int view, int component, int type, std::size_t count);

/// Notes the least and the largest of each of the `width` components in an accessor.
void add_bounds(tinygltf::Model& model, int accessor, const float* values, std::size_t width);

/// `count` elements of a vertex attribute, and their accessor.
int add_vertex_data(tinygltf::Model& model,
                    const void* data,
                    std::size_t size,
                    int component,
                    int type,
                    std::size_t count);

template <class T, std::size_t N>
int add_attribute(tinygltf::Model& model,
                  const std::vector<std::array<T, N>>& values,
                  int component,
                  int type) {
  return add_vertex_data(
      model, values.data(), values.size() * sizeof values[0], component, type, values.size());
}

/// The same for places or displacements, which have bounds.
int add_places(tinygltf::Model& model, const std::vector<std::array<float, 3>>& places);

}  // namespace crosspatch
