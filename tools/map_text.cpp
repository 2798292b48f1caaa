#include "tools/map_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "tools/text_lines.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

}  // namespace

void append_point(std::string& text, const SurfacePoint& p) {
  if (p.valid())
    // 17 digits read back as the same double.
    fmt::format_to(std::back_inserter(text),
                   "{} {:.17g} {:.17g} {:.17g}",
                   p.face,
                   p.bary[0],
                   p.bary[1],
                   p.bary[2]);
  else
    text += "-1 0 0 0";
}

std::vector<SurfacePoint> map_of_file_vertices(const SurfaceMap& map,
                                               const PreparedMesh& source,
                                               const PreparedMesh& target) {
  std::vector<SurfacePoint> points;
  for (const int v : source.numbering.mesh_vertex) {
    const int point = v < 0 ? -1 : map.point_of_source_vertex[at(v)];
    points.push_back(point < 0 ? SurfacePoint{} : to_file(target, map.target[at(point)]));
  }
  return points;
}

std::string map_text(const std::vector<SurfacePoint>& points) {
  std::string text;
  for (const SurfacePoint& p : points) {
    append_point(text, p);
    text += '\n';
  }
  return text;
}

Result<std::vector<SurfacePoint>> parse_map(std::string_view text,
                                            int point_count,
                                            int triangle_count) {
  constexpr double kSumError = 1e-6;  // files of other programs may be written in single precision
  std::vector<SurfacePoint> points;
  for (const TextLine& line : text_lines(text)) {
    SurfacePoint p;
    bool good = line.words.size() == 4 && parse_number(line.words[0], p.face);
    for (int k = 0; good && k < 3; ++k) good = parse_number(line.words[at(k + 1)], p.bary[k]);
    if (!good)
      return fail(ErrorCode::kBadInput,
                  fmt::format("line {}: not of the form 'face b0 b1 b2'", line.number));
    if (p.face < -1 || p.face >= triangle_count)
      return fail(
          ErrorCode::kBadInput,
          fmt::format("line {}: face {} is outside [-1, {})", line.number, p.face, triangle_count));
    if (p.valid() && !(std::abs(p.bary.sum() - 1) <= kSumError))
      return fail(
          ErrorCode::kBadInput,
          fmt::format(
              "line {}: barycentric coordinates sum to {}, not 1", line.number, p.bary.sum()));
    points.push_back(p);
  }
  if (points.size() != at(point_count))
    return fail(ErrorCode::kBadInput,
                fmt::format("{} lines for {} vertices", points.size(), point_count));
  return points;
}

}  // namespace crosspatch
