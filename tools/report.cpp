#include "tools/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tools/sha256.hpp"
#include "tools/version.hpp"

namespace crosspatch {
namespace {

using nlohmann::ordered_json;

/// Path, size and hash of a file.
ordered_json file_json(const std::string& path) {
  ordered_json json = {{"path", path}, {"bytes", nullptr}, {"sha256", nullptr}};
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) return json;
  json["bytes"] = bytes.size();
  json["sha256"] = sha256(bytes);
  return json;
}

/// Whole numbers without a fraction.
ordered_json number_json(double value) {
  const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
  return whole ? ordered_json(static_cast<std::int64_t>(value)) : ordered_json(value);
}

ordered_json numbers_json(const std::map<std::string, double>& numbers) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, value] : numbers) json[name] = number_json(value);
  return json;
}

ordered_json inputs_json(const RunReport& report) {
  ordered_json inputs = ordered_json::array();
  for (const InputSummary& summary : report.inputs) {
    ordered_json input = {{"role", summary.role}};
    input.update(file_json(summary.path));
    input["counts"] = numbers_json(summary.counts);
    input["notes"] = summary.notes;
    input["repairs"] = summary.repairs;
    inputs.push_back(std::move(input));
  }
  for (const std::string& path : report.other_inputs) {
    ordered_json input = {{"role", "other"}};
    input.update(file_json(path));
    inputs.push_back(std::move(input));
  }
  return inputs;
}

}  // namespace

InputSummary summarize(const std::string& role, const std::string& path, const PolygonSoup& soup) {
  const std::size_t triangles = fan_triangle_corners(soup).size() / 3;
  return {.role = role,
          .path = path,
          .counts = {{"vertices", static_cast<double>(soup.positions.rows())},
                     {"polygons", soup.polygon_count()},
                     {"triangles", static_cast<double>(triangles)},
                     {"uv_sets", static_cast<double>(soup.uv_sets.size())},
                     {"materials", static_cast<double>(soup.materials.size())},
                     {"images", static_cast<double>(soup.images.size())}},
          .notes = soup.notes,
          .repairs = {}};
}

InputSummary summarize(const std::string& role,
                       const std::string& path,
                       const PolygonSoup& soup,
                       const PreparedMesh& prepared) {
  InputSummary summary = summarize(role, path, soup);
  const TriangleMesh& mesh = prepared.mesh;
  summary.counts["mesh_vertices"] = mesh.vertex_count();
  summary.counts["mesh_triangles"] = mesh.face_count();
  summary.counts["genus"] = genus(mesh);
  summary.counts["boundary_loops"] = static_cast<double>(boundary_loops(mesh).size());
  summary.counts["area"] = total_area(mesh);
  summary.repairs = prepared.repairs;
  return summary;
}

std::string report_json(const RunReport& report) {
  ordered_json json = {
      {"schema", {{"name", "crosspatch-report"}, {"version", kReportVersion}}},
      {"program", {{"name", "crosspatch"}, {"version", kVersion}, {"command", report.command}}},
      {"inputs", inputs_json(report)},
      {"options", report.options}};
  ordered_json stages = ordered_json::array();
  double seconds = 0;
  for (const StageRecord& stage : report.stages) {
    stages.push_back({{"name", stage.name},
                      {"seconds", stage.seconds},
                      {"peak_memory_mib", stage.peak_memory_mib}});
    seconds += stage.seconds;
  }
  json["stages"] = std::move(stages);
  json["seconds"] = seconds;
  json["peak_memory_mib"] = peak_memory_mib();
  json["quality"] = numbers_json(report.quality);
  json["warnings"] = report.warnings;
  json["outputs"] = report.outputs;
  json["exit_code"] = report.exit_code;
  // Names of files need not be UTF-8; what is not becomes the replacement character.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

std::string summary_text(const InputSummary& summary) {
  std::string text = fmt::format("{}: {}\n", summary.role, summary.path);
  for (const auto& [name, value] : summary.counts) text += fmt::format("  {}: {}\n", name, value);
  for (const std::string& note : summary.notes) text += fmt::format("  note: {}\n", note);
  for (const std::string& repair : summary.repairs) text += fmt::format("  repair: {}\n", repair);
  return text;
}

}  // namespace crosspatch
