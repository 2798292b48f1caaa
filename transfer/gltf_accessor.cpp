#include "transfer/gltf_accessor.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>

namespace crosspatch {
namespace {

/// A run of equally spaced elements inside a buffer.
struct Run {
  const unsigned char* data = nullptr;
  std::size_t stride = 0;
};

std::size_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

template <class T>
double load(const unsigned char* data) {
  T value;
  std::memcpy(&value, data, sizeof value);  // glTF promises alignment, a file need not keep it
  return static_cast<double>(value);
}

double load_component(int type, const unsigned char* data) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load<std::int8_t>(data);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(data);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load<std::int16_t>(data);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(data);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(data);
    default:
      return load<float>(data);
  }
}

/// glTF 2.0, section 3.11: normalized integers as real numbers.
double normalized_component(int type, double value) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return std::max(value / 127, -1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return value / 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return std::max(value / 32767, -1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return value / 65535;
    default:
      return value;
  }
}

/// `count` elements of `size` bytes from `offset` of a buffer view; `tight` ignores its stride.
Result<Run> find_run(const tinygltf::Model& model,
                     int view_index,
                     std::uint64_t offset,
                     std::uint64_t count,
                     std::uint64_t size,
                     bool tight) {
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
  const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  const std::uint64_t stride = tight || view.byteStride == 0 ? size : view.byteStride;
  constexpr std::uint64_t kMostStride = 252;  // glTF 2.0, section 5.11.4
  if (stride < size || (stride != size && stride > kMostStride))
    return fail(ErrorCode::kBadInput,
                fmt::format("byteStride {} for elements of {} bytes", stride, size));
  const bool view_fits =
      view.byteOffset <= data.size() && view.byteLength <= data.size() - view.byteOffset;
  // count < 2^32 and stride < 2^8, so nothing overflows.
  const std::uint64_t needed = count == 0 ? 0 : (count - 1) * stride + size;
  if (!view_fits || offset > view.byteLength || needed > view.byteLength - offset)
    return fail(ErrorCode::kBadInput,
                fmt::format("{} elements of {} bytes from byte {} do not fit buffer view {} of {}",
                            count,
                            size,
                            offset,
                            view_index,
                            view.byteLength));
  return Run{data.data() + view.byteOffset + offset, static_cast<std::size_t>(stride)};
}

void copy_element(const tinygltf::Accessor& accessor,
                  const unsigned char* from,
                  int components,
                  double* to) {
  const std::size_t size = component_size(accessor.componentType);
  for (int k = 0; k < components; ++k) {
    const double value =
        load_component(accessor.componentType, from + static_cast<std::size_t>(k) * size);
    to[k] = accessor.normalized ? normalized_component(accessor.componentType, value) : value;
  }
}

Status apply_sparse(const tinygltf::Model& model,
                    const tinygltf::Accessor& accessor,
                    GltfValues& out) {
  const auto& sparse = accessor.sparse;
  const std::uint64_t count = static_cast<std::uint64_t>(std::max(sparse.count, 0));
  const std::size_t index_size = component_size(sparse.indices.componentType);
  if (sparse.count < 0 || count > out.count() || index_size == 0 || sparse.indices.byteOffset < 0 ||
      sparse.values.byteOffset < 0 || sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
    return fail(ErrorCode::kBadInput,
                fmt::format("sparse part with {} elements of {}", sparse.count, out.count()));
  const std::uint64_t size =
      component_size(accessor.componentType) * static_cast<std::uint64_t>(out.components);
  const auto indices = find_run(model,
                                sparse.indices.bufferView,
                                static_cast<std::uint64_t>(sparse.indices.byteOffset),
                                count,
                                index_size,
                                true);
  if (!indices) return tl::unexpected(indices.error());
  const auto values = find_run(model,
                               sparse.values.bufferView,
                               static_cast<std::uint64_t>(sparse.values.byteOffset),
                               count,
                               size,
                               true);
  if (!values) return tl::unexpected(values.error());
  for (std::size_t i = 0; i < count; ++i) {
    const double at =
        load_component(sparse.indices.componentType, indices->data + i * indices->stride);
    if (!(at >= 0 && at < static_cast<double>(out.count())))
      return fail(ErrorCode::kBadInput,
                  fmt::format("sparse index {} is outside [0, {})", at, out.count()));
    copy_element(
        accessor,
        values->data + i * values->stride,
        out.components,
        &out.values[static_cast<std::size_t>(at) * static_cast<std::size_t>(out.components)]);
  }
  return {};
}

Result<GltfValues> read_checked(const tinygltf::Model& model,
                                const tinygltf::Accessor& accessor,
                                std::int64_t max_count) {
  // Zeros that no byte of the file stands for are kept few.
  constexpr std::int64_t kMostZeros = 1'000'000;
  const std::size_t component = component_size(accessor.componentType);
  GltfValues out{component_count(accessor.type), {}};
  if (component == 0 || out.components == 0)
    return fail(ErrorCode::kBadInput,
                fmt::format("type {} of component {}", accessor.type, accessor.componentType));
  const std::int64_t most = accessor.bufferView < 0 ? std::min(max_count, kMostZeros) : max_count;
  if (accessor.count > static_cast<std::uint64_t>(most))
    return fail(ErrorCode::kBadInput,
                fmt::format("{} elements, at most {} are read", accessor.count, most));
  const std::size_t components = static_cast<std::size_t>(out.components);
  if (accessor.bufferView >= 0) {
    const auto run = find_run(model,
                              accessor.bufferView,
                              accessor.byteOffset,
                              accessor.count,
                              component * components,
                              false);
    if (!run) return tl::unexpected(run.error());
    out.values.resize(accessor.count * components);
    for (std::size_t i = 0; i < accessor.count; ++i)
      copy_element(
          accessor, run->data + i * run->stride, out.components, &out.values[i * components]);
  } else {
    out.values.assign(accessor.count * components, 0.0);
  }
  if (accessor.sparse.isSparse)
    if (Status s = apply_sparse(model, accessor, out); !s) return tl::unexpected(s.error());
  return out;
}

}  // namespace

Result<GltfValues> read_accessor(const tinygltf::Model& model, int index, std::int64_t max_count) {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  auto values = read_checked(model, accessor, max_count);
  if (!values)
    return fail(values.error().code, fmt::format("accessor {}: {}", index, values.error().message));
  return values;
}

}  // namespace crosspatch
