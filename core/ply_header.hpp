#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace crosspatch {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

/// The scalar types of PLY; kInt8 .. kUint32 are integers.
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t byte_size(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< of a list
};

struct PlyElement {
  std::string name;
  long long count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  std::vector<std::string> texture_files;  ///< `comment TextureFile NAME`
  std::string_view body;                   ///< what follows the header
};

/// Reads the header of a PLY file. kBadInput: no `ply` in front, no `end_header`, unknown words,
/// a count below 0 or for which the file has no bytes.
Result<PlyHeader> read_ply_header(std::string_view bytes);

}  // namespace crosspatch
