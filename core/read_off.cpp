// Object File Format (Geomview), ASCII, with the optional prefixes ST, C and N: one vertex and one
// polygon a line; what follows a polygon's indices is its colour and is passed over.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/soup_formats.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {
namespace {

struct OffHeader {
  long long vertices = 0, polygons = 0;
};

tl::unexpected<Error> bad_line(const LineReader& lines, const std::string& what) {
  return fail(ErrorCode::kBadInput, fmt::format("line {}: {}", lines.number(), what));
}

Result<OffHeader> read_header(LineReader& lines) {
  auto line = lines.next_meaningful();
  std::string_view rest = line.value_or("");
  const std::string_view magic = take_word(rest);
  if (magic != "OFF" && magic != "COFF" && magic != "NOFF" && magic != "CNOFF" &&
      magic != "STOFF" && magic != "STCOFF" && magic != "STNOFF" && magic != "STCNOFF")
    return bad_line(lines, fmt::format("{} where OFF is expected", in_quotes(magic)));
  if (rest.find("BINARY") != std::string_view::npos)
    return bad_line(lines, "binary OFF is not read");
  if (trimmed(rest).empty()) {
    line = lines.next_meaningful();
    rest = line.value_or("");
  }
  const auto vertices = to_integer(take_word(rest)), polygons = to_integer(take_word(rest));
  if (!vertices || !polygons || *vertices < 0 || *polygons < 0)
    return bad_line(lines, "two counts of 0 or more are expected");
  // A vertex takes at least "0 0 0\n", a polygon "0\n"; the last line may lack its end.
  const long long left = static_cast<long long>(lines.rest().size()) + 1;
  if (*vertices > left / 6 || *polygons > left / 2)
    return bad_line(
        lines,
        fmt::format(
            "{} vertices and {} polygons declared, {} bytes left", *vertices, *polygons, left - 1));
  return OffHeader{*vertices, *polygons};
}

Status read_polygon(std::string_view line, long long vertices, PolygonSoup& soup) {
  const std::string_view first = take_word(line);
  const auto corners = to_integer(first);
  if (!corners || *corners < 0 || *corners > static_cast<long long>(line.size()) / 2 + 1)
    return fail(ErrorCode::kBadInput,
                fmt::format("{} corners do not fit on the line", in_quotes(first)));
  for (long long k = 0; k < *corners; ++k) {
    const std::string_view word = take_word(line);
    const auto v = to_integer(word);
    if (!v || *v < 0 || *v >= vertices)
      return fail(ErrorCode::kBadInput,
                  fmt::format("vertex {} is outside [0, {})", in_quotes(word), vertices));
    soup.corner_vertex.push_back(static_cast<int>(*v));
  }
  end_polygon(soup);
  return {};
}

}  // namespace

Result<PolygonSoup> parse_off(std::string_view text, const ReadLimits& limits) {
  LineReader lines(text);
  const auto header = read_header(lines);
  if (!header) return tl::unexpected(header.error());
  PolygonSoup soup;
  std::vector<double> coordinates;
  for (long long v = 0; v < header->vertices; ++v) {
    auto line = lines.next_meaningful();
    if (!line) return bad_line(lines, fmt::format("{} of {} vertices found", v, header->vertices));
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = take_word(*line);
      const auto value = to_double(word);
      if (!value || !std::isfinite(*value))
        return bad_line(lines, fmt::format("vertex: {} is not a finite number", in_quotes(word)));
      coordinates.push_back(*value);
    }
    if (Status s = check_size(soup, coordinates, limits); !s) return tl::unexpected(s.error());
  }
  for (long long p = 0; p < header->polygons; ++p) {
    const auto line = lines.next_meaningful();
    if (!line) return bad_line(lines, fmt::format("{} of {} polygons found", p, header->polygons));
    if (Status s = read_polygon(*line, header->vertices, soup); !s)
      return bad_line(lines, s.error().message);
    if (Status s = check_size(soup, coordinates, limits); !s) return tl::unexpected(s.error());
  }
  soup.positions = as_positions(coordinates);
  return soup;
}

}  // namespace crosspatch
