// crosspatch match, map and transfer: a run over a pair, then its outputs.
#include <fmt/format.h>

#include "tools/commands.hpp"
#include "tools/map_text.hpp"
#include "tools/output_files.hpp"
#include "tools/pipeline.hpp"
#include "tools/report.hpp"
#include "transfer/gltf_write.hpp"

namespace crosspatch {
namespace {

constexpr double kCoverageGate = 1 - 1e-9;  // rounding of summed areas
/// What a map of surfaces with holes has to cover of both: they need not be the same holes.
constexpr double kPartialCoverageGate = 0.9;

bool is_partial(const MatchedMap& matched) {
  return matched.holes[0] + matched.holes[1] > 0;
}

/// What makes a finished run end with kGateFailed, a sentence each.
std::vector<std::string> gate_failures(const PairRun& run) {
  const MapQuality& quality = run.matched.result.quality;
  std::vector<std::string> warnings;
  if (quality.flipped > 0)
    warnings.push_back(fmt::format("{} pieces of the map are turned over", quality.flipped));
  const bool partial = is_partial(run.matched);
  const double gate = partial ? kPartialCoverageGate : kCoverageGate;
  if (quality.source_coverage < gate || quality.target_coverage < gate)
    warnings.push_back(
        fmt::format("the map covers {:.2f} % of the source and {:.2f} % of the target",
                    100 * quality.source_coverage,
                    100 * quality.target_coverage));
  const TriangleMesh &source = run.source.prepared.mesh, &target = run.target.prepared.mesh;
  const Status bijective = partial ? validate_partial(run.matched.result.map, source, target)
                                   : validate(run.matched.result.map, source, target);
  if (!bijective) warnings.push_back("the map is not one-to-one: " + bijective.error().message);
  return warnings;
}

std::map<std::string, double> map_figures(const MatchedMap& matched) {
  const MapResult& map = matched.result;
  const MapQuality& quality = map.quality;
  return {{"flipped_triangles", quality.flipped},
          {"coverage", quality.target_coverage},
          {"source_coverage", quality.source_coverage},
          {"symmetric_dirichlet_mean", quality.mean},
          {"symmetric_dirichlet_median", quality.median},
          {"symmetric_dirichlet_90", quality.percentile_90},
          {"symmetric_dirichlet_99", quality.percentile_99},
          {"worst_stretch", quality.worst_stretch},
          {"initial_distortion", matched.ranking.front().distortion},
          {"coarse_energy", matched.ranking.front().energy},
          {"candidates", static_cast<double>(matched.ranking.size())},
          {"margin", matched.margin},
          {"overlay_points", map.map.point_count()},
          {"overlay_polygons", map.map.polygon_count()}};
}

std::map<std::string, double> transfer_figures(const CarryTextureStatistics& statistics) {
  return {{"coverage", statistics.coverage},
          {"triangles", statistics.triangles},
          {"seam_cuts", statistics.seam_cuts},
          {"overlay_triangles", statistics.overlay_triangles},
          {"max_uv_error_texels", statistics.max_uv_error_texels},
          {"max_color_error", statistics.max_color_error},
          {"unmapped_faces", statistics.unmapped_faces},
          {"degenerate_polygons", statistics.degenerate_polygons}};
}

std::vector<InputSummary> input_summaries(const PairFiles& files, const PairRun& run) {
  return {summarize("source", files.source, run.source.soup, run.source.prepared),
          summarize("target", files.target, run.target.soup, run.target.prepared)};
}

RunReport pair_report(const PairArguments& arguments, const PairRun& run) {
  const PairFiles& files = arguments.files;
  RunReport report;
  report.inputs = input_summaries(files, run);
  if (!files.landmarks.empty()) report.other_inputs = {files.landmarks};
  report.quality = map_figures(run.matched);
  report.warnings = gate_failures(run);
  report.exit_code =
      static_cast<int>(report.warnings.empty() ? ExitCode::kDone : ExitCode::kGateFailed);
  if (is_partial(run.matched))
    report.warnings.push_back(
        fmt::format("{} holes of the source and {} of the target were closed for the map and are "
                    "no part of it: "
                    "{:.2f} % of the source and {:.2f} % of the target are mapped",
                    run.matched.holes[0],
                    run.matched.holes[1],
                    100 * run.matched.result.quality.source_coverage,
                    100 * run.matched.result.quality.target_coverage));
  if (run.matched.margin < kSafeMargin)
    report.warnings.push_back(fmt::format(
        "the choice among the candidate maps is unsure, left and right may be exchanged: "
        "the margin is {:.3f}, {} is safe",
        run.matched.margin,
        kSafeMargin));
  return report;
}

/// Writes `outputs` and, if asked for, the report that lists them; says the warnings.
Result<ExitCode> finish(std::vector<OutputFile> outputs,
                        RunReport report,
                        const CommonArguments& common,
                        const Progress& progress) {
  for (const OutputFile& output : outputs) report.outputs.push_back(output.path);
  report.stages = progress.records();
  if (!common.json.empty()) outputs.push_back({common.json, report_json(report)});
  if (const Status written = write_output_files(outputs); !written)
    return tl::unexpected(written.error());
  for (const std::string& warning : report.warnings) print_warning(warning);
  return static_cast<ExitCode>(report.exit_code);
}

/// The file's vertex for each vertex of the mesh; the first, where several were welded.
std::vector<int> file_vertices(const PreparedMesh& prepared) {
  const std::vector<int>& mesh_vertex = prepared.numbering.mesh_vertex;
  std::vector<int> file_vertex(static_cast<std::size_t>(prepared.mesh.vertex_count()), -1);
  for (std::size_t v = mesh_vertex.size(); v-- > 0;)
    if (mesh_vertex[v] >= 0)
      file_vertex[static_cast<std::size_t>(mesh_vertex[v])] = static_cast<int>(v);
  return file_vertex;
}

/// One line a match, under a header.
std::string matching_text(const Matching& matching,
                          const PreparedMesh& source,
                          const PreparedMesh& target) {
  const std::vector<int> of_source = file_vertices(source), of_target = file_vertices(target);
  std::string text = "kind,source_vertex,target_vertex,confidence\n";
  for (const Match& match : matching.matches)
    text += fmt::format("{},{},{},{:.6g}\n",
                        name(match.kind),
                        of_source[static_cast<std::size_t>(match.source_vertex)],
                        of_target[static_cast<std::size_t>(match.target_vertex)],
                        match.confidence);
  return text;
}

Result<ExitCode> run_paper_match(const MatchArguments& arguments) {
  Progress progress(arguments.pair.common.quiet, 4);
  const PairFiles& files = arguments.pair.files;
  const Result<PairRun> run = read_pair(files, progress);
  if (!run) return tl::unexpected(run.error());
  const Result<Matching> matching = paper_matching(*run, progress);
  if (!matching) return tl::unexpected(matching.error());
  RunReport report;
  report.command = "match";
  report.inputs = input_summaries(files, *run);
  report.options = {{"method", "paper"}};
  report.quality = {{"matches", static_cast<double>(matching->matches.size())}};
  return finish(
      {{arguments.output, matching_text(*matching, run->source.prepared, run->target.prepared)}},
      std::move(report),
      arguments.pair.common,
      progress);
}

}  // namespace

Result<ExitCode> run(const MatchArguments& arguments) {
  if (arguments.method == MatchChoice::kPaper) return run_paper_match(arguments);
  Progress progress(arguments.pair.common.quiet, stage_count(LastStage::kMap));
  const Result<PairRun> run = run_pair(arguments.pair.files, LastStage::kMap, progress);
  if (!run) return tl::unexpected(run.error());
  const Matching matching = judged_matching(*run);
  RunReport report = pair_report(arguments.pair, *run);
  report.command = "match";
  report.options = {{"method", "default"}};
  report.quality["matches"] = static_cast<double>(matching.matches.size());
  return finish(
      {{arguments.output, matching_text(matching, run->source.prepared, run->target.prepared)}},
      std::move(report),
      arguments.pair.common,
      progress);
}

Result<ExitCode> run(const MapArguments& arguments) {
  Progress progress(arguments.pair.common.quiet, stage_count(LastStage::kMap));
  const Result<PairRun> run = run_pair(arguments.pair.files, LastStage::kMap, progress);
  if (!run) return tl::unexpected(run.error());
  const PreparedMesh &source = run->source.prepared, &target = run->target.prepared;
  const SurfaceMap& map = run->matched.result.map;
  std::vector<OutputFile> outputs = {
      {arguments.output, map_text(map_of_file_vertices(map, source, target))}};
  if (!arguments.inverse.empty())
    outputs.push_back(
        {arguments.inverse, map_text(map_of_file_vertices(inverse(map), target, source))});
  if (!arguments.overlay.empty())
    outputs.push_back({arguments.overlay, overlay_text(map, source, target)});
  RunReport report = pair_report(arguments.pair, *run);
  report.command = "map";
  return finish(std::move(outputs), std::move(report), arguments.pair.common, progress);
}

Result<ExitCode> run(const TransferArguments& arguments) {
  Progress progress(arguments.pair.common.quiet, stage_count(LastStage::kTransfer));
  const Result<PairRun> run = run_pair(arguments.pair.files, LastStage::kTransfer, progress);
  if (!run) return tl::unexpected(run.error());
  Result<std::string> glb = encode_glb(run->carried.mesh);
  if (!glb) return tl::unexpected(glb.error());
  RunReport report = pair_report(arguments.pair, *run);
  report.command = "transfer";
  report.options = {{"mode", "keep"}};
  for (const auto& [name, value] : transfer_figures(run->carried.statistics))
    report.quality[name] = value;
  return finish(
      {{arguments.output, std::move(*glb)}}, std::move(report), arguments.pair.common, progress);
}

}  // namespace crosspatch
