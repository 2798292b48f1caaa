#include "tools/overlay_text.hpp"

#include <fmt/format.h>

#include <iterator>

#include "core/index.hpp"
#include "tools/map_text.hpp"
#include "tools/text_lines.hpp"

namespace crosspatch {
namespace {

constexpr std::string_view kHeader = "crosspatch-overlay";

tl::unexpected<Error> bad_line(const TextLine& line, const std::string& reason) {
  return fail(ErrorCode::kBadInput, fmt::format("line {}: {}", line.number, reason));
}

/// "face b0 b1 b2" from word `first` on, as a point of the mesh.
Result<SurfacePoint> parse_point(const TextLine& line,
                                 std::size_t first,
                                 const PreparedMesh& mesh) {
  SurfacePoint p;
  bool good = parse_number(line.words[first], p.face) && p.face >= 0;
  for (int k = 0; good && k < 3; ++k)
    good = parse_number(line.words[first + 1 + idx(k)], p.bary[k]);
  if (!good || !(std::abs(p.bary.sum() - 1) < 1e-6))
    return bad_line(line, "not of the form 'face b0 b1 b2' with weights that sum to 1");
  const SurfacePoint inside = from_file(mesh, p);
  if (!inside.valid())
    return bad_line(line, fmt::format("triangle {} is no part of the mesh", p.face));
  return inside;
}

/// Mesh face of each triangle of the file, -1 where it was left out.
std::vector<int> mesh_faces(const PreparedMesh& mesh) {
  std::vector<int> face(mesh.numbering.triangle_corners.size() / 3, -1);
  for (std::size_t f = 0; f < mesh.numbering.file_triangle.size(); ++f)
    face[idx(mesh.numbering.file_triangle[f])] = static_cast<int>(f);
  return face;
}

/// Overlay point at each vertex of `mesh`, found by the points' weights, or -1.
std::vector<int> points_at_vertices(const TriangleMesh& mesh,
                                    const std::vector<SurfacePoint>& points) {
  std::vector<int> at_vertex(idx(mesh.vertex_count()), -1);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (points[i].bary[k] == 1) at_vertex[idx(mesh.F(points[i].face, k))] = static_cast<int>(i);
  return at_vertex;
}

}  // namespace

std::string overlay_text(const SurfaceMap& map,
                         const PreparedMesh& source,
                         const PreparedMesh& target) {
  std::string text =
      fmt::format("crosspatch-overlay 1\n{} {}\n", map.point_count(), map.polygon_count());
  for (int i = 0; i < map.point_count(); ++i) {
    append_point(text, to_file(source, map.source[idx(i)]));
    text += ' ';
    append_point(text, to_file(target, map.target[idx(i)]));
    text += '\n';
  }
  for (int p = 0; p < map.polygon_count(); ++p) {
    const int begin = map.polygon_begin[idx(p)], end = map.polygon_begin[idx(p + 1)];
    fmt::format_to(std::back_inserter(text), "{}", end - begin);
    for (int c = begin; c < end; ++c)
      fmt::format_to(std::back_inserter(text), " {}", map.corner[idx(c)]);
    fmt::format_to(std::back_inserter(text),
                   " {} {}\n",
                   source.numbering.file_triangle[idx(map.source_face[idx(p)])],
                   target.numbering.file_triangle[idx(map.target_face[idx(p)])]);
  }
  return text;
}

bool is_overlay_text(std::string_view text) {
  return text.starts_with(kHeader);
}

Result<SurfaceMap> parse_overlay(std::string_view text,
                                 const PreparedMesh& source,
                                 const PreparedMesh& target) {
  const std::vector<TextLine> lines = text_lines(text);
  int points = 0, polygons = 0, version = 0;
  if (lines.size() < 2 || lines[0].words.size() != 2 || lines[0].words[0] != kHeader ||
      !parse_number(lines[0].words[1], version) || version != 1)
    return fail(ErrorCode::kBadInput, "not an overlay of version 1");
  if (lines[1].words.size() != 2 || !parse_number(lines[1].words[0], points) ||
      !parse_number(lines[1].words[1], polygons) || points < 0 || polygons < 0)
    return bad_line(lines[1], "not of the form '#points #polygons'");
  if (lines.size() != 2 + idx(points) + idx(polygons))
    return fail(
        ErrorCode::kBadInput,
        fmt::format("{} lines for {} points and {} polygons", lines.size() - 2, points, polygons));
  SurfaceMap map;
  for (std::size_t i = 2; i < 2 + idx(points); ++i) {
    if (lines[i].words.size() != 8) return bad_line(lines[i], "a point has 8 numbers");
    const auto a = parse_point(lines[i], 0, source), b = parse_point(lines[i], 4, target);
    if (!a) return tl::unexpected(a.error());
    if (!b) return tl::unexpected(b.error());
    map.source.push_back(*a);
    map.target.push_back(*b);
  }
  const std::vector<int> of_source = mesh_faces(source), of_target = mesh_faces(target);
  const auto in = [](int i, std::size_t size) { return i >= 0 && idx(i) < size; };
  for (std::size_t i = 2 + idx(points); i < lines.size(); ++i) {
    std::vector<int> numbers(lines[i].words.size());
    bool good = numbers.size() >= 6;
    for (std::size_t k = 0; good && k < numbers.size(); ++k)
      good = parse_number(lines[i].words[k], numbers[k]);
    if (!good || idx(numbers[0]) != numbers.size() - 3)
      return bad_line(lines[i], "not of the form 'n p0 ... p(n-1) fa fb'");
    for (std::size_t k = 1; k + 2 < numbers.size(); ++k) {
      if (!in(numbers[k], idx(points)))
        return bad_line(lines[i], fmt::format("point {} is outside [0, {})", numbers[k], points));
      map.corner.push_back(numbers[k]);
    }
    const int fa = numbers[numbers.size() - 2], fb = numbers.back();
    if (!in(fa, of_source.size()) || !in(fb, of_target.size()) || of_source[idx(fa)] < 0 ||
        of_target[idx(fb)] < 0)
      return bad_line(lines[i], fmt::format("triangle {} or {} is no part of the mesh", fa, fb));
    map.source_face.push_back(of_source[idx(fa)]);
    map.target_face.push_back(of_target[idx(fb)]);
    map.polygon_begin.push_back(static_cast<int>(map.corner.size()));
  }
  map.point_of_source_vertex = points_at_vertices(source.mesh, map.source);
  map.point_of_target_vertex = points_at_vertices(target.mesh, map.target);
  return map;
}

}  // namespace crosspatch
