#include "tools/pair_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/feature_graph.hpp"
#include "core/features.hpp"
#include "core/index.hpp"
#include "param/map_quality.hpp"
#include "tools/base64.hpp"
#include "tools/display_mesh.hpp"
#include "tools/palette.hpp"
#include "tools/verdicts.hpp"
#include "tools/viewer.hpp"

namespace crosspatch {
namespace {

using nlohmann::ordered_json;

/// Places of the page's meshes may be off by this share of the source's extent.
constexpr double kPlaceTolerance = 0.005;

template <class T>
std::string packed(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(bytes);
}

/// A box whose coordinates are counted in 65535ths of its largest extent.
struct Grid {
  Vector3d low = Vector3d::Zero();
  double size = 1;

  explicit Grid(const MatrixX3d& V)
      : low(V.colwise().minCoeff().transpose()),
        size(std::max((V.colwise().maxCoeff() - V.colwise().minCoeff()).maxCoeff(), 1e-300)) {}

  [[nodiscard]] std::array<std::uint16_t, 3> steps(const Vector3d& p) const {
    std::array<std::uint16_t, 3> s{};
    for (int k = 0; k < 3; ++k)
      s[idx(k)] = static_cast<std::uint16_t>(
          std::lround(std::clamp((p[k] - low[k]) / size, 0.0, 1.0) * 65535));
    return s;
  }
  [[nodiscard]] ordered_json json() const {
    return {{"low", {low[0], low[1], low[2]}}, {"size", size}};
  }
};

double at(const Eigen::VectorXd& values, const TriangleMesh& mesh, const SurfacePoint& p) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += p.bary[k] * values[mesh.F(p.face, k)];
  return sum;
}

std::uint8_t byte(double unit) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(unit, 0.0, 1.0) * 255));
}

/// Everything about one of the two surfaces that is drawn on it.
struct SurfaceView {
  const AttributedMesh mesh;
  ShapeFeatures features;
  FeatureGraph graph;
  std::vector<int> file_vertex;  ///< per vertex of the prepared mesh
};

std::vector<int> file_vertices(const PreparedMesh& prepared) {
  std::vector<int> file_vertex(idx(prepared.mesh.vertex_count()), -1);
  const std::vector<int>& mesh_vertex = prepared.numbering.mesh_vertex;
  for (std::size_t v = mesh_vertex.size(); v-- > 0;)
    if (mesh_vertex[v] >= 0) file_vertex[idx(mesh_vertex[v])] = static_cast<int>(v);
  return file_vertex;
}

Result<SurfaceView> view_surface(const InputMesh& input) {
  const TriangleMesh unit = normalized(input.prepared.mesh);
  auto features = compute_features(unit);
  if (!features) return tl::unexpected(features.error());
  auto graph = build_feature_graph(unit,
                                   features->log_adf.array().exp().matrix(),
                                   features->spectrum.values[1],
                                   {.complex = {.threshold = 0.02, .scale = FieldScale::kLog}});
  if (!graph) return tl::unexpected(graph.error());
  return SurfaceView{{input.prepared, input.soup},
                     std::move(*features),
                     std::move(*graph),
                     file_vertices(input.prepared)};
}

ordered_json point(const Vector3d& p) {
  return {p[0], p[1], p[2]};
}

ordered_json graph_json(const SurfaceView& view) {
  const TriangleMesh& mesh = view.mesh.prepared.mesh;
  ordered_json nodes = ordered_json::array(), arcs = ordered_json::array();
  for (const MorseNode& node : view.graph.complex.nodes)
    nodes.push_back({{"kind", name(node.kind)}, {"at", point(mesh.position(node.vertex))}});
  for (std::size_t a = 0; a < view.graph.arcs.size(); ++a) {
    const FeatureArc& arc = view.graph.arcs[a];
    std::vector<float> path;
    for (const int v : arc.path)
      for (int k = 0; k < 3; ++k) path.push_back(static_cast<float>(mesh.V(v, k)));
    arcs.push_back({{"from", arc.saddle},
                    {"to", arc.extremum},
                    {"weight", arc.weight},
                    {"added", a >= view.graph.complex.arcs.size()},
                    {"path", packed(path)}});
  }
  return {{"nodes", nodes}, {"arcs", arcs}};
}

/// Sides between triangles that carry different texture coordinates or materials, as segments.
std::vector<float> seams(const TexturedMesh& mesh) {
  std::map<std::pair<int, int>, std::pair<int, int>> first;  // side -> triangle and corner
  std::vector<float> segments;
  const auto differ = [&](int t, int k, int u, int j) {
    if (mesh.material[idx(t)] != mesh.material[idx(u)]) return true;
    return std::any_of(mesh.uv_sets.begin(), mesh.uv_sets.end(), [&](const auto& uv) {
      const auto apart = [&](int c, int d) { return (uv[idx(c)] - uv[idx(d)]).norm() > 1e-7; };
      return apart(3 * t + k, 3 * u + (j + 1) % 3) || apart(3 * t + (k + 1) % 3, 3 * u + j);
    });
  };
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles(t, k), b = mesh.triangles(t, (k + 1) % 3);
      const auto other = first.find({b, a});
      if (other == first.end()) {
        first[{a, b}] = {t, k};
        continue;
      }
      if (!differ(t, k, other->second.first, other->second.second)) continue;
      for (const int v : {a, b})
        for (int i = 0; i < 3; ++i) segments.push_back(static_cast<float>(mesh.positions(v, i)));
    }
  return segments;
}

/// Patch of each face of the surface by the complex: the maximum that its highest path leads to and
/// the minimum that its lowest one does.
std::vector<std::uint8_t> basins(const SurfaceView& view) {
  const TriangleMesh& mesh = view.mesh.prepared.mesh;
  std::vector<std::uint8_t> patch(idx(mesh.face_count()), 0);
  auto gradient = discrete_gradient(mesh, view.features.log_adf.array().exp().matrix());
  if (!gradient) return patch;
  const auto hierarchy = persistence_hierarchy(*gradient, FieldScale::kLog);
  if (!hierarchy) return patch;
  const GradientForests f = forests(simplify(std::move(*gradient), *hierarchy, 0.02));
  std::map<std::pair<int, int>, int> number;
  for (int face = 0; face < mesh.face_count(); ++face) {
    const std::pair<int, int> ends(f.maximum[idx(face)], f.minimum[idx(mesh.F(face, 0))]);
    const auto entry = number.try_emplace(ends, static_cast<int>(number.size())).first;
    patch[idx(face)] = static_cast<std::uint8_t>(entry->second % 255);
  }
  return patch;
}

/// Vertices of a mesh as the page gets them: every attribute at once tells them apart.
struct PageVertex {
  std::array<std::uint16_t, 3> position{}, place{};
  std::array<std::int8_t, 3> normal{};
  std::array<float, 2> uv{};
  std::array<std::uint8_t, 3> color{};
  std::uint8_t adf = 0, distortion = 0, patch = 0, mapped = 1;
  auto operator<=>(const PageVertex&) const = default;
};

class MeshWriter {
 public:
  MeshWriter(const SurfaceView& view, const Grid& places) : view_(view), places_(places) {}

  ordered_json write(const DisplayMesh& display, const Eigen::VectorXd& distortion) {
    const TexturedMesh& mesh = display.mesh;
    const Grid grid(mesh.positions);
    const Eigen::VectorXd& adf = view_.features.log_adf;
    const double low = adf.minCoeff(), range = std::max(adf.maxCoeff() - low, 1e-300);
    ordered_json groups = ordered_json::array();
    std::map<int, std::vector<int>> of_material;
    for (int t = 0; t < mesh.triangle_count(); ++t) of_material[mesh.material[idx(t)]].push_back(t);
    for (const auto& [material, triangles] : of_material) {
      groups.push_back({index_.size(), 3 * triangles.size(), material});
      const Material& m = mesh.materials[idx(material)];
      for (const int t : triangles)
        for (int k = 0; k < 3; ++k) {
          const std::size_t c = idx(3 * t + k);
          const SurfacePoint& p = display.corner[c];
          PageVertex v;
          v.position = grid.steps(mesh.positions.row(mesh.triangles(t, k)).transpose());
          v.mapped = display.place[c].allFinite() ? 1 : 0;
          if (v.mapped != 0) v.place = places_.steps(display.place[c]);
          for (int i = 0; i < 3; ++i)
            v.normal[idx(i)] = static_cast<std::int8_t>(std::lround(mesh.normals[c][i] * 127));
          if (m.base_color.image >= 0) {
            const Vector2d uv =
                transformed(mesh.uv_sets[idx(m.base_color.uv_set)][c], m.base_color.transform);
            v.uv = {static_cast<float>(uv[0]), static_cast<float>(uv[1])};
          }
          for (std::size_t i = 0; i < 3; ++i)
            v.color[i] = byte(mesh.colors.empty() ? 1 : std::sqrt(double(mesh.colors[c][i])));
          v.adf = byte((at(adf, view_.mesh.prepared.mesh, p) - low) / range);
          v.distortion = byte(distortion_place(at(distortion, view_.mesh.prepared.mesh, p)));
          v.patch = display.patch[idx(t)];
          add(v);
        }
    }
    ordered_json json = {{"grid", grid.json()}, {"groups", groups}, {"index", packed(index_)}};
    json["position"] = packed(all(&PageVertex::position));
    json["normal"] = packed(all(&PageVertex::normal));
    json["place"] = packed(all(&PageVertex::place));
    json["uv"] = packed(all(&PageVertex::uv));
    if (!mesh.colors.empty()) json["color"] = packed(all(&PageVertex::color));
    json["adf"] = packed(all(&PageVertex::adf));
    json["distortion"] = packed(all(&PageVertex::distortion));
    json["patch"] = packed(all(&PageVertex::patch));
    json["mapped"] = packed(all(&PageVertex::mapped));
    json["seams"] = packed(seams(mesh));
    json["triangles"] = mesh.triangle_count();
    return json;
  }

 private:
  void add(const PageVertex& v) {
    const auto [entry, fresh] =
        number_.try_emplace(v, static_cast<std::uint32_t>(vertices_.size()));
    if (fresh) vertices_.push_back(v);
    index_.push_back(entry->second);
  }

  template <class T>
  [[nodiscard]] std::vector<T> all(T PageVertex::*member) const {
    std::vector<T> values;
    values.reserve(vertices_.size());
    for (const PageVertex& v : vertices_) values.push_back(v.*member);
    return values;
  }

  const SurfaceView& view_;
  const Grid& places_;
  std::map<PageVertex, std::uint32_t> number_;
  std::vector<PageVertex> vertices_;
  std::vector<std::uint32_t> index_;
};

/// The vertices that landmarks can name: places, and numbers in the file.
ordered_json vertices_json(const SurfaceView& view) {
  std::vector<float> positions;
  for (Eigen::Index v = 0; v < view.mesh.prepared.mesh.V.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      positions.push_back(static_cast<float>(view.mesh.prepared.mesh.V(v, k)));
  return {{"position", packed(positions)}, {"number", packed(view.file_vertex)}};
}

ordered_json materials_json(const TexturedMesh& mesh) {
  ordered_json materials = ordered_json::array();
  for (const Material& m : mesh.materials)
    materials.push_back({{"name", m.name},
                         {"color", m.base_color_factor},
                         {"image", m.base_color.image},
                         {"wrap", {m.base_color.wrap_s, m.base_color.wrap_t}}});
  return materials;
}

/// Images that base colours use, as data URIs; others are empty.
ordered_json images_json(const TexturedMesh& mesh) {
  std::vector<bool> used(mesh.images.size(), false);
  for (const Material& m : mesh.materials)
    if (m.base_color.image >= 0) used[idx(m.base_color.image)] = true;
  ordered_json images = ordered_json::array();
  for (std::size_t i = 0; i < used.size(); ++i) {
    const ImageFile& image = mesh.images[i];
    images.push_back(
        used[i] && !image.mime_type.empty()
            ? "data:" + image.mime_type + ";base64," +
                  base64({reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size()})
            : std::string());
  }
  return images;
}

ordered_json matches_json(const std::vector<Landmark>& landmarks,
                          double confidence,
                          const SurfaceView& source,
                          const SurfaceView& target) {
  ordered_json matches = ordered_json::array();
  for (const Landmark& l : landmarks)
    matches.push_back({{"source", point(source.mesh.prepared.mesh.position(l.source_vertex))},
                       {"target", point(target.mesh.prepared.mesh.position(l.target_vertex))},
                       {"source_vertex", source.file_vertex[idx(l.source_vertex)]},
                       {"target_vertex", target.file_vertex[idx(l.target_vertex)]},
                       {"given", l.pinned},
                       {"confidence", l.pinned ? 1 : confidence}});
  return matches;
}

/// The characters that end a script or a string early, made harmless.
std::string in_script(std::string text) {
  for (std::size_t i = text.find("</"); i != std::string::npos; i = text.find("</", i + 3))
    text.replace(i, 2, "<\\/");
  return text;
}

std::string in_html(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<')
      safe += "&lt;";
    else if (c == '&')
      safe += "&amp;";
    else
      safe += c;
  }
  return safe;
}

std::string page(const std::string& title, const std::string& data) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n</head>\n<body>\n"
      "<noscript>This page needs JavaScript.</noscript>\n"
      "<script id=\"data\" type=\"application/json\">{}</script>\n<script>{}</script>\n"
      "</body>\n</html>\n",
      in_html(title),
      in_script(data),
      in_script(std::string(viewer_script())));
}

}  // namespace

Result<std::string> pair_page(const PairRun& run, const RunReport& report) {
  if (viewer_script().empty())
    return fail(ErrorCode::kOutput, "--report: this build has no viewer; see crosspatch doctor");
  const auto source = view_surface(run.source);
  if (!source) return tl::unexpected(source.error());
  const auto target = view_surface(run.target);
  if (!target) return tl::unexpected(target.error());
  const std::vector<std::uint8_t> patches = basins(*source);
  const auto own = display_source(source->mesh, patches);
  if (!own) return tl::unexpected(own.error());
  const Grid places(own->mesh.positions);
  ordered_json data = {{"version", 1}};
  const auto file = [](const std::string& path) {
    return std::filesystem::path(path).filename().string();
  };
  const std::string title =
      fmt::format("{} to {}", file(report.inputs[0].path), file(report.inputs[1].path));
  data["title"] = title;
  data["places"] = places.json();
  data["materials"] = materials_json(own->mesh);
  data["images"] = images_json(own->mesh);
  ordered_json maps = ordered_json::array();
  const auto add = [&](const char* label,
                       const MapResult& result,
                       const std::vector<Landmark>& landmarks,
                       double margin) -> Status {
    const SurfaceMap& map = result.map;
    const auto carried = display_target(source->mesh, target->mesh, patches, map, kPlaceTolerance);
    if (!carried) return tl::unexpected(carried.error());
    const VertexDistortion distortion =
        vertex_distortion(map, run.source.prepared.mesh, run.target.prepared.mesh);
    maps.push_back(
        {{"name", label},
         {"margin", std::isfinite(margin) ? ordered_json(margin) : ordered_json()},
         {"materials", materials_json(carried->mesh)},
         {"source", MeshWriter(*source, places).write(*own, distortion.source)},
         {"target", MeshWriter(*target, places).write(*carried, distortion.target)},
         {"matches", matches_json(landmarks, confidence(margin, result.quality), *source, *target)},
         {"median_energy", result.quality.median}});
    return {};
  };
  const MatchedMap& matched = run.matched;
  const std::vector<Landmark> landmarks =
      matched.ranking.empty() ? run.landmarks : matched.ranking.front().landmarks;
  if (Status s = add("chosen", matched.result, landmarks, matched.margin); !s)
    return tl::unexpected(s.error());
  if (!matched.alternatives.empty()) {
    const Alternative& other = matched.alternatives.front();
    if (Status s = add("runner-up", other.result, other.landmarks, other.margin); !s)
      return tl::unexpected(s.error());
  }
  data["maps"] = std::move(maps);
  data["graphs"] = {{"source", graph_json(*source)}, {"target", graph_json(*target)}};
  data["vertices"] = {{"source", vertices_json(*source)}, {"target", vertices_json(*target)}};
  ordered_json inputs = ordered_json::array();
  for (const InputSummary& input : report.inputs)
    inputs.push_back({{"role", input.role},
                      {"path", file(input.path)},
                      {"counts", input.counts},
                      {"notes", input.notes},
                      {"repairs", input.repairs}});
  data["inputs"] = std::move(inputs);
  data["warnings"] = report.warnings;
  ordered_json figures = ordered_json::array();
  for (const FigureVerdict& v : verdicts(report.quality))
    figures.push_back({{"name", v.name}, {"value", v.value}, {"level", v.level}, {"text", v.text}});
  data["figures"] = std::move(figures);
  return page(title, data.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

}  // namespace crosspatch
