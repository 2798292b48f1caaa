#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "core/ply_header.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {

/// Takes numbers off the body of a PLY file; empty where the body ends or no number stands.
class PlyBody {
 public:
  explicit PlyBody(const PlyHeader& header) : format_(header.format), rest_(header.body) {}

  std::optional<double> take(PlyType type) {
    if (format_ == PlyFormat::kAscii) return to_double(take_word(rest_));
    const std::size_t size = byte_size(type);
    if (rest_.size() < size) return std::nullopt;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t at = format_ == PlyFormat::kBigEndian ? i : size - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(rest_[at]);
    }
    rest_.remove_prefix(size);
    return from_bits(type, bits);
  }

  [[nodiscard]] std::size_t bytes_left() const { return rest_.size(); }

 private:
  static double from_bits(PlyType type, std::uint64_t bits) {
    switch (type) {
      case PlyType::kInt8:
        return static_cast<std::int8_t>(bits);
      case PlyType::kInt16:
        return static_cast<std::int16_t>(bits);
      case PlyType::kInt32:
        return static_cast<std::int32_t>(bits);
      case PlyType::kFloat32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case PlyType::kFloat64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  PlyFormat format_;
  std::string_view rest_;
};

/// What a property of a vertex means to us.
enum PlyVertexSlot {
  kX,
  kY,
  kZ,
  kNx,
  kNy,
  kNz,
  kU,
  kV,
  kRed,
  kGreen,
  kBlue,
  kAlpha,
  kSlots,
  kIgnored
};

inline PlyVertexSlot ply_vertex_slot(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyVertexSlot>, 20> kNames{
      {{"x", kX},
       {"y", kY},
       {"z", kZ},
       {"nx", kNx},
       {"ny", kNy},
       {"nz", kNz},
       {"u", kU},
       {"v", kV},
       {"s", kU},
       {"t", kV},
       {"texture_u", kU},
       {"texture_v", kV},
       {"texture_s", kU},
       {"texture_t", kV},
       {"red", kRed},
       {"green", kGreen},
       {"blue", kBlue},
       {"alpha", kAlpha},
       {"diffuse_red", kRed},
       {"diffuse_green", kGreen}}};
  for (const auto& [known, slot] : kNames)
    if (known == name) return slot;
  return name == "diffuse_blue" ? kBlue : kIgnored;
}

}  // namespace crosspatch
