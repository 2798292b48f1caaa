#pragma once

#include <optional>
#include <vector>

#include "core/result.hpp"

namespace tinygltf {
class Model;
}

namespace crosspatch {

/// The elements of an accessor one after the other, integers scaled to [0, 1] or [-1, 1] where the
/// accessor is normalized.
struct GltfValues {
  int components = 1;  ///< 1 to 4, or 16 of a matrix, column by column
  std::vector<double> values;

  [[nodiscard]] std::size_t count() const {
    return values.size() / static_cast<std::size_t>(components);
  }
};

/// Reads accessor `index` of `model` (whose indices are in range, see check_gltf_json) with its
/// sparse part. kBadInput: an element outside the buffer view, a type or component this cannot
/// be, a sparse index out of range, or `count` above `max_count`.
Result<GltfValues> read_accessor(const tinygltf::Model& model, int index, std::int64_t max_count);

}  // namespace crosspatch
