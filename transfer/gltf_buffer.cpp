#include "transfer/gltf_buffer.hpp"

#include <tiny_gltf.h>

#include <algorithm>

#include "core/index.hpp"

namespace crosspatch {

int add_view(tinygltf::Model& model, const void* data, std::size_t size, int target) {
  auto& bytes = model.buffers[0].data;
  bytes.resize((bytes.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = size;
  view.target = target;
  const auto* begin = static_cast<const unsigned char*>(data);
  bytes.insert(bytes.end(), begin, begin + size);
  bytes.resize((bytes.size() + 3) / 4 * 4);
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int add_accessor(tinygltf::Model& model, int view, int component, int type, std::size_t count) {
  tinygltf::Accessor accessor;
  accessor.bufferView = view;
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

void add_bounds(tinygltf::Model& model, int index, const float* values, std::size_t width) {
  tinygltf::Accessor& accessor = model.accessors[idx(index)];
  for (std::size_t k = 0; k < width; ++k) {
    float least = values[k], most = values[k];
    for (std::size_t i = 1; i < accessor.count; ++i) {
      least = std::min(least, values[width * i + k]);
      most = std::max(most, values[width * i + k]);
    }
    accessor.minValues.push_back(double(least));
    accessor.maxValues.push_back(double(most));
  }
}

int add_vertex_data(tinygltf::Model& model,
                    const void* data,
                    std::size_t size,
                    int component,
                    int type,
                    std::size_t count) {
  const int view = add_view(model, data, size, TINYGLTF_TARGET_ARRAY_BUFFER);
  return add_accessor(model, view, component, type, count);
}

int add_places(tinygltf::Model& model, const std::vector<std::array<float, 3>>& places) {
  const int index = add_attribute(model, places, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
  add_bounds(model, index, places.front().data(), 3);
  return index;
}

}  // namespace crosspatch
