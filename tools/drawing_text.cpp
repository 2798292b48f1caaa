#include "tools/drawing_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/index.hpp"

namespace crosspatch {
namespace {

using nlohmann::ordered_json;

constexpr const char* kForms = "a point is a vertex, [face, b0, b1, b2] or null";

tl::unexpected<Error> bad(const std::string& entry, const std::string& reason) {
  return fail(ErrorCode::kBadInput, fmt::format("{}: {}", entry, reason));
}

Result<SurfacePoint> at_vertex(const ordered_json& json,
                               const std::string& entry,
                               const PreparedMesh& mesh) {
  const std::vector<int>& mesh_vertex = mesh.numbering.mesh_vertex;
  const auto vertex = json.get<std::int64_t>();
  if (vertex < 0 || vertex >= static_cast<std::int64_t>(mesh_vertex.size()))
    return bad(entry, fmt::format("vertex {} is outside [0, {})", vertex, mesh_vertex.size()));
  const int v = mesh_vertex[static_cast<std::size_t>(vertex)];
  return v < 0 ? SurfacePoint{} : point_at_vertex(mesh.mesh, v);
}

Result<SurfacePoint> in_triangle(const ordered_json& json,
                                 const std::string& entry,
                                 const PreparedMesh& mesh) {
  constexpr double kSumError = 1e-6;  // files of other programs may be written in single precision
  bool good = json.size() == 4 && json[0].is_number_integer();
  for (std::size_t k = 1; good && k < 4; ++k) good = json[k].is_number();
  if (!good) return bad(entry, kForms);
  const auto face = json[0].get<std::int64_t>();
  const std::size_t faces = mesh.numbering.triangle_corners.size() / 3;
  if (face < 0 || face >= static_cast<std::int64_t>(faces))
    return bad(entry, fmt::format("triangle {} is outside [0, {})", face, faces));
  SurfacePoint p{static_cast<int>(face), Vector3d::Zero()};
  for (int k = 0; k < 3; ++k) p.bary[k] = json[idx(k + 1)].get<double>();
  if (!(std::abs(p.bary.sum() - 1) <= kSumError))
    return bad(entry, fmt::format("barycentric coordinates sum to {}, not 1", p.bary.sum()));
  if (p.bary.minCoeff() < -kSumError)
    return bad(entry, fmt::format("barycentric coordinate {} is negative", p.bary.minCoeff()));
  p.bary = p.bary.cwiseMax(0.0);
  p.bary /= p.bary.sum();
  return from_file(mesh, p);
}

Result<SurfacePoint> parse_point(const ordered_json& json,
                                 const std::string& entry,
                                 const PreparedMesh& mesh) {
  if (json.is_null()) return SurfacePoint{};
  if (json.is_number_integer()) return at_vertex(json, entry, mesh);
  if (json.is_array()) return in_triangle(json, entry, mesh);
  return bad(entry, kForms);
}

/// The name of an entry, and how it is spoken of.
Result<std::string> name_of(const ordered_json& json, const std::string& entry) {
  if (!json.is_object()) return bad(entry, "is no object");
  const auto name = json.find("name");
  if (name == json.end()) return std::string();
  if (!name->is_string()) return bad(entry, "\"name\" is no string");
  return name->get<std::string>();
}

Status parse_landmark(const ordered_json& json,
                      const std::string& entry,
                      const PreparedMesh& mesh,
                      Drawing& drawing) {
  const Result<std::string> name = name_of(json, entry);
  if (!name) return tl::unexpected(name.error());
  if (!json.contains("point")) return bad(entry, "has no \"point\"");
  const Result<SurfacePoint> point = parse_point(json["point"], entry, mesh);
  if (!point) return tl::unexpected(point.error());
  drawing.landmarks.push_back({*name, *point});
  return {};
}

Status parse_curve(const ordered_json& json,
                   const std::string& entry,
                   const PreparedMesh& mesh,
                   Drawing& drawing) {
  const Result<std::string> name = name_of(json, entry);
  if (!name) return tl::unexpected(name.error());
  SurfaceCurve curve{*name, false, {}};
  if (const auto closed = json.find("closed"); closed != json.end()) {
    if (!closed->is_boolean()) return bad(entry, "\"closed\" is neither true nor false");
    curve.closed = closed->get<bool>();
  }
  const auto points = json.find("points");
  if (points == json.end() || !points->is_array()) return bad(entry, "has no list \"points\"");
  for (std::size_t i = 0; i < points->size(); ++i) {
    const auto point = parse_point((*points)[i], fmt::format("{}, point {}", entry, i), mesh);
    if (!point) return tl::unexpected(point.error());
    curve.points.push_back(*point);
  }
  const std::size_t least = curve.closed ? 3 : 2;
  if (curve.points.size() < least)
    return bad(entry, fmt::format("has {} points, {} are needed", curve.points.size(), least));
  drawing.curves.push_back(std::move(curve));
  return {};
}

ordered_json point_json(const SurfacePoint& p, const PreparedMesh& mesh) {
  if (!p.valid()) return nullptr;
  const SurfacePoint q = to_file(mesh, p);
  return {q.face, q.bary[0], q.bary[1], q.bary[2]};
}

ordered_json position_json(const SurfacePoint& p, const PreparedMesh& mesh) {
  if (!p.valid()) return nullptr;
  const Vector3d x = position(mesh.mesh, p);
  return {x[0], x[1], x[2]};
}

ordered_json curve_json(const SurfaceCurve& curve, const PreparedMesh& mesh) {
  ordered_json points = ordered_json::array(), positions = ordered_json::array();
  double length = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    points.push_back(point_json(curve.points[i], mesh));
    positions.push_back(position_json(curve.points[i], mesh));
    if (i + 1 == curve.points.size() && !curve.closed) continue;
    length += (position(mesh.mesh, curve.points[(i + 1) % curve.points.size()]) -
               position(mesh.mesh, curve.points[i]))
                  .norm();
  }
  return {{"name", curve.name},
          {"closed", curve.closed},
          {"length", length},
          {"points", std::move(points)},
          {"positions", std::move(positions)}};
}

/// One entry a line: files of thousands of points stay readable.
std::string list_text(const ordered_json& list) {
  std::string text = "[";
  const char* separator = "\n    ";
  for (const ordered_json& entry : list) {
    // Names need not be UTF-8; what is not becomes the replacement character.
    text += separator + entry.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    separator = ",\n    ";
  }
  return text + "\n  ]";
}

}  // namespace

Result<Drawing> parse_drawing(std::string_view text, const PreparedMesh& mesh) {
  const ordered_json json = ordered_json::parse(text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::kBadInput, "is no JSON");
  if (!json.is_object()) return fail(ErrorCode::kBadInput, "is no JSON object");
  Drawing drawing;
  for (const auto& [key, one, parse] : {std::tuple("landmarks", "landmark", &parse_landmark),
                                        std::tuple("curves", "curve", &parse_curve)}) {
    const auto list = json.find(key);
    if (list == json.end()) continue;
    if (!list->is_array()) return fail(ErrorCode::kBadInput, fmt::format("\"{}\" is no list", key));
    for (std::size_t i = 0; i < list->size(); ++i)
      if (Status s =
              parse((*list)[i], fmt::format("{} {} (counted from 0)", one, i), mesh, drawing);
          !s)
        return tl::unexpected(s.error());
  }
  if (drawing.landmarks.empty() && drawing.curves.empty())
    return fail(ErrorCode::kBadInput, "has neither \"landmarks\" nor \"curves\"");
  return drawing;
}

std::string drawing_json(const Drawing& drawing, const PreparedMesh& mesh) {
  ordered_json landmarks = ordered_json::array(), curves = ordered_json::array();
  for (const MarkedPoint& mark : drawing.landmarks)
    landmarks.push_back({{"name", mark.name},
                         {"point", point_json(mark.point, mesh)},
                         {"position", position_json(mark.point, mesh)}});
  for (const SurfaceCurve& curve : drawing.curves) curves.push_back(curve_json(curve, mesh));
  return fmt::format(
      "{{\n  \"landmarks\": {},\n  \"curves\": {}\n}}\n", list_text(landmarks), list_text(curves));
}

std::string drawing_ply(const Drawing& drawing, const PreparedMesh& mesh) {
  std::string vertices, edges;
  int vertex_count = 0, edge_count = 0;
  const auto add = [&](const SurfacePoint& p, int curve) {
    const Vector3d x = position(mesh.mesh, p);
    vertices += fmt::format("{:.17g} {:.17g} {:.17g} {}\n", x[0], x[1], x[2], curve);
    return vertex_count++;
  };
  for (const MarkedPoint& mark : drawing.landmarks)
    if (mark.point.valid()) add(mark.point, -1);
  for (std::size_t c = 0; c < drawing.curves.size(); ++c) {
    const SurfaceCurve& curve = drawing.curves[c];
    const int first = vertex_count;
    for (const SurfacePoint& p : curve.points) add(p, static_cast<int>(c));
    for (int v = first; v + (curve.closed ? 0 : 1) < vertex_count; ++v, ++edge_count)
      edges += fmt::format("{} {}\n", v, v + 1 < vertex_count ? v + 1 : first);
  }
  return fmt::format(
             "ply\nformat ascii 1.0\ncomment crosspatch\nelement vertex {}\nproperty double x\n"
             "property double y\nproperty double z\nproperty int curve\nelement edge {}\n"
             "property int vertex1\nproperty int vertex2\nend_header\n",
             vertex_count,
             edge_count) +
         vertices + edges;
}

}  // namespace crosspatch
