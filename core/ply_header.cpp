#include "core/ply_header.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "core/file_bytes.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {
namespace {

std::optional<PlyType> type_named(std::string_view word) {
  if (word == "char" || word == "int8") return PlyType::kInt8;
  if (word == "uchar" || word == "uint8") return PlyType::kUint8;
  if (word == "short" || word == "int16") return PlyType::kInt16;
  if (word == "ushort" || word == "uint16") return PlyType::kUint16;
  if (word == "int" || word == "int32") return PlyType::kInt32;
  if (word == "uint" || word == "uint32") return PlyType::kUint32;
  if (word == "float" || word == "float32") return PlyType::kFloat32;
  if (word == "double" || word == "float64") return PlyType::kFloat64;
  return std::nullopt;
}

bool is_integer(PlyType type) {
  return type != PlyType::kFloat32 && type != PlyType::kFloat64;
}

Status read_format(std::string_view rest, PlyHeader& header) {
  const std::string_view word = take_word(rest);
  if (word == "ascii")
    header.format = PlyFormat::kAscii;
  else if (word == "binary_little_endian")
    header.format = PlyFormat::kLittleEndian;
  else if (word == "binary_big_endian")
    header.format = PlyFormat::kBigEndian;
  else
    return fail(ErrorCode::kBadInput, fmt::format("unknown format {}", in_quotes(word)));
  return {};
}

Status read_element(std::string_view rest, PlyHeader& header) {
  PlyElement element;
  element.name = take_word(rest);
  const std::string_view word = take_word(rest);
  const auto count = to_integer(word);
  if (!count || *count < 0)
    return fail(ErrorCode::kBadInput,
                fmt::format("element {}: count {} is no number of 0 or more",
                            in_quotes(element.name),
                            in_quotes(word)));
  element.count = *count;
  header.elements.push_back(std::move(element));
  return {};
}

Status read_property(std::string_view rest, PlyHeader& header) {
  if (header.elements.empty()) return fail(ErrorCode::kBadInput, "a property before any element");
  PlyProperty property;
  std::string_view word = take_word(rest);
  if (word == "list") {
    property.is_list = true;
    word = take_word(rest);
    const auto count_type = type_named(word);
    if (!count_type || !is_integer(*count_type))
      return fail(ErrorCode::kBadInput, fmt::format("{} cannot count a list", in_quotes(word)));
    property.count_type = *count_type;
    word = take_word(rest);
  }
  const auto type = type_named(word);
  if (!type) return fail(ErrorCode::kBadInput, fmt::format("unknown type {}", in_quotes(word)));
  property.type = *type;
  property.name = take_word(rest);
  header.elements.back().properties.push_back(std::move(property));
  return {};
}

Status read_line(std::string_view line, PlyHeader& header) {
  const std::string_view keyword = take_word(line);
  if (keyword == "format") return read_format(line, header);
  if (keyword == "element") return read_element(line, header);
  if (keyword == "property") return read_property(line, header);
  if (keyword == "comment") {
    if (take_word(line) == "TextureFile") header.texture_files.emplace_back(trimmed(line));
    return {};
  }
  if (keyword == "obj_info" || keyword.empty()) return {};
  return fail(ErrorCode::kBadInput, fmt::format("unknown word {}", in_quotes(keyword)));
}

/// Every count must have the bytes it needs at the very least.
Status check_counts(const PlyHeader& header) {
  std::size_t left = header.body.size() + 1;  // the last line may lack its end
  for (const PlyElement& element : header.elements) {
    std::size_t least = 0;
    for (const PlyProperty& p : element.properties)
      least +=
          header.format == PlyFormat::kAscii ? 2 : byte_size(p.is_list ? p.count_type : p.type);
    if (element.properties.empty())
      return fail(ErrorCode::kBadInput,
                  fmt::format("element {}: has no properties", in_quotes(element.name)));
    if (static_cast<std::size_t>(element.count) > left / least)
      return fail(ErrorCode::kBadInput,
                  fmt::format("element {}: {} declared, {} bytes left",
                              in_quotes(element.name),
                              element.count,
                              left - 1));
    left -= static_cast<std::size_t>(element.count) * least;
  }
  return {};
}

}  // namespace

std::size_t byte_size(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

Result<PlyHeader> read_ply_header(std::string_view bytes) {
  constexpr std::size_t kMostElements = 100;
  LineReader lines(bytes);
  auto line = lines.next();
  if (!line || trimmed(*line) != "ply")
    return fail(ErrorCode::kBadInput, "the first line is not 'ply'");
  PlyHeader header;
  bool has_format = false;
  while ((line = lines.next()) && trimmed(*line) != "end_header") {
    has_format = has_format || line->starts_with("format");
    if (Status s = read_line(*line, header); !s)
      return fail(s.error().code,
                  fmt::format("header line {}: {}", lines.number(), s.error().message));
    if (header.elements.size() > kMostElements)
      return fail(ErrorCode::kBadInput,
                  fmt::format("header: more than {} elements", kMostElements));
  }
  if (!line) return fail(ErrorCode::kBadInput, "the header has no 'end_header'");
  if (!has_format) return fail(ErrorCode::kBadInput, "the header names no format");
  header.body = lines.rest();
  if (Status s = check_counts(header); !s) return tl::unexpected(s.error());
  return header;
}

}  // namespace crosspatch
