#include "tools/point_map_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/index.hpp"
#include "tools/text_lines.hpp"

namespace crosspatch {
namespace {

/// An index of the file counted from 0, or -1.
Result<int> parse_index(const TextLine& line, int base, std::size_t count, const char* thing) {
  int index = 0;
  double written = 0;
  if (parse_number(line.words[0], written) && std::isnan(written)) return -1;
  if (!parse_number(line.words[0], index))
    return fail(ErrorCode::kBadInput,
                fmt::format("line {}: '{}' is no {}", line.number, line.words[0], thing));
  if (index == -1) return -1;
  if (index < base || index - base >= static_cast<int>(count)) {
    const bool off_by_one = base == 0 && index == static_cast<int>(count);
    return fail(ErrorCode::kBadInput,
                fmt::format("line {}: {} {} is outside [{}, {}){}",
                            line.number,
                            thing,
                            index,
                            base,
                            base + static_cast<int>(count),
                            off_by_one ? "; --map-base 1 tells that the file counts from 1" : ""));
  }
  return index - base;
}

Result<SurfacePoint> parse_vertex(const TextLine& line, int base, const PreparedMesh& target) {
  const std::vector<int>& mesh_vertex = target.numbering.mesh_vertex;
  const Result<int> vertex = parse_index(line, base, mesh_vertex.size(), "vertex");
  if (!vertex) return tl::unexpected(vertex.error());
  if (*vertex < 0 || mesh_vertex[idx(*vertex)] < 0) return SurfacePoint{};
  return point_at_vertex(target.mesh, mesh_vertex[idx(*vertex)]);
}

Result<SurfacePoint> parse_barycentric(const TextLine& line, int base, const PreparedMesh& target) {
  constexpr double kError = 1e-6;  // files may be written in single precision
  const Result<int> face =
      parse_index(line, base, target.numbering.triangle_corners.size() / 3, "triangle");
  if (!face) return tl::unexpected(face.error());
  SurfacePoint p{*face, Vector3d::Zero()};
  for (int k = 0; k < 3; ++k)
    if (!parse_number(line.words[idx(k + 1)], p.bary[k]))
      return fail(ErrorCode::kBadInput,
                  fmt::format("line {}: not of the form 'face b0 b1 b2'", line.number));
  if (!p.valid()) return SurfacePoint{};
  if (!(std::abs(p.bary.sum() - 1) <= kError))
    return fail(
        ErrorCode::kBadInput,
        fmt::format(
            "line {}: barycentric coordinates sum to {}, not 1", line.number, p.bary.sum()));
  if (p.bary.minCoeff() < -kError)
    return fail(
        ErrorCode::kBadInput,
        fmt::format(
            "line {}: barycentric coordinate {} is negative", line.number, p.bary.minCoeff()));
  p.bary = p.bary.cwiseMax(0.0);
  p.bary /= p.bary.sum();
  return from_file(target, p);
}

}  // namespace

Result<std::vector<SurfacePoint>> parse_point_map(std::string_view text,
                                                  int base,
                                                  const PreparedMesh& source,
                                                  const PreparedMesh& target) {
  const std::vector<int>& mesh_vertex = source.numbering.mesh_vertex;
  const std::vector<TextLine> lines = text_lines(text);
  std::vector<SurfacePoint> images(idx(source.mesh.vertex_count()));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t columns = lines[i].words.size();
    if (columns != 1 && columns != 4)
      return fail(ErrorCode::kBadInput,
                  fmt::format("line {}: {} columns, neither 1 ('vertex') nor 4 ('face b0 b1 b2')",
                              lines[i].number,
                              columns));
    if (columns != lines[0].words.size())
      return fail(ErrorCode::kBadInput,
                  fmt::format("line {}: {} columns, the first line has {}",
                              lines[i].number,
                              columns,
                              lines[0].words.size()));
    const Result<SurfacePoint> image = columns == 1 ? parse_vertex(lines[i], base, target)
                                                    : parse_barycentric(lines[i], base, target);
    if (!image) return tl::unexpected(image.error());
    const int v = i < mesh_vertex.size() ? mesh_vertex[i] : -1;
    if (v >= 0 && !images[idx(v)].valid()) images[idx(v)] = *image;
  }
  if (lines.size() != mesh_vertex.size())
    return fail(
        ErrorCode::kBadInput,
        fmt::format("{} lines for the source's {} vertices", lines.size(), mesh_vertex.size()));
  return images;
}

}  // namespace crosspatch
