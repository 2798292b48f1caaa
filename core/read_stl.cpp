// Stereolithography files, ASCII or binary. Every facet brings three vertices of its own; its
// normal is passed over.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/soup_formats.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {
namespace {

constexpr std::size_t kBinaryHeader = 84, kBinaryFacet = 50;

std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

/// Corner c is vertex c; three corners a facet.
PolygonSoup soup_of_facets(const std::vector<double>& coordinates) {
  PolygonSoup soup;
  soup.positions = as_positions(coordinates);
  for (int v = 0; v < soup.positions.rows(); ++v) {
    soup.corner_vertex.push_back(v);
    if (v % 3 == 2) end_polygon(soup);
  }
  return soup;
}

Result<PolygonSoup> parse_binary(std::string_view bytes, const ReadLimits& limits) {
  const std::uint64_t facets = little_endian(bytes.substr(80, 4));
  if (static_cast<std::int64_t>(facets) > limits.max_triangles)
    return fail(ErrorCode::kBadInput,
                fmt::format("{} facets, at most {} are read", facets, limits.max_triangles));
  if (kBinaryHeader + kBinaryFacet * facets > bytes.size())
    return fail(ErrorCode::kBadInput,
                fmt::format("{} facets declared, the file's {} bytes hold {}",
                            facets,
                            bytes.size(),
                            (bytes.size() - kBinaryHeader) / kBinaryFacet));
  std::vector<double> coordinates;
  coordinates.reserve(9 * facets);
  for (std::uint64_t f = 0; f < facets; ++f)
    for (std::size_t k = 0; k < 9; ++k) {
      const std::size_t at = kBinaryHeader + kBinaryFacet * f + 12 + 4 * k;
      const float value = std::bit_cast<float>(little_endian(bytes.substr(at, 4)));
      if (!std::isfinite(value))
        return fail(ErrorCode::kBadInput,
                    fmt::format("facet {} (counted from 0): a coordinate is not finite", f));
      coordinates.push_back(value);
    }
  PolygonSoup soup = soup_of_facets(coordinates);
  const std::size_t left = bytes.size() - kBinaryHeader - kBinaryFacet * facets;
  if (left > 0) soup.notes.push_back(fmt::format("{} bytes after the last facet", left));
  return soup;
}

Result<PolygonSoup> parse_ascii(std::string_view text, const ReadLimits& limits) {
  LineReader lines(text);
  std::vector<double> coordinates;
  std::size_t loop_begin = 0;
  bool in_loop = false, ended = false;
  while (const auto line = lines.next()) {
    std::string_view rest = *line;
    const std::string_view keyword = take_word(rest);
    ended = keyword == "endsolid" || (ended && keyword.empty());
    const auto bad = [&](const std::string& what) {
      return fail(ErrorCode::kBadInput, fmt::format("line {}: {}", lines.number(), what));
    };
    if (keyword == "outer") {
      if (in_loop) return bad("a loop begins inside a loop");
      in_loop = true;
      loop_begin = coordinates.size();
    } else if (keyword == "vertex") {
      if (!in_loop) return bad("a vertex outside any loop");
      for (int k = 0; k < 3; ++k) {
        const std::string_view word = take_word(rest);
        const auto value = to_double(word);
        if (!value || !std::isfinite(*value))
          return bad(fmt::format("vertex: {} is not a finite number", in_quotes(word)));
        coordinates.push_back(*value);
      }
    } else if (keyword == "endloop") {
      if (!in_loop || coordinates.size() != loop_begin + 9)
        return bad("a facet must have one loop of three vertices");
      in_loop = false;
      if (static_cast<std::int64_t>(coordinates.size() / 9) > limits.max_triangles)
        return bad(fmt::format("more than {} facets", limits.max_triangles));
    } else if (keyword != "solid" && keyword != "facet" && keyword != "endfacet" &&
               keyword != "endsolid" && !keyword.empty()) {
      return bad(fmt::format("{} is no word of an ASCII STL file", in_quotes(keyword)));
    }
  }
  if (in_loop) return fail(ErrorCode::kBadInput, "the file ends inside a facet");
  PolygonSoup soup = soup_of_facets(coordinates);
  if (!ended) soup.notes.emplace_back("the file ends without 'endsolid'");
  return soup;
}

}  // namespace

Result<PolygonSoup> parse_stl(std::string_view bytes, const ReadLimits& limits) {
  // Binary files may begin with "solid" too, so the size decides first.
  if (bytes.size() >= kBinaryHeader &&
      bytes.size() ==
          kBinaryHeader + kBinaryFacet * std::uint64_t{little_endian(bytes.substr(80, 4))})
    return parse_binary(bytes, limits);
  if (trimmed(bytes).starts_with("solid")) return parse_ascii(bytes, limits);
  if (bytes.size() >= kBinaryHeader) return parse_binary(bytes, limits);
  return fail(ErrorCode::kBadInput,
              fmt::format("neither ASCII STL nor binary STL: {} bytes", bytes.size()));
}

}  // namespace crosspatch
