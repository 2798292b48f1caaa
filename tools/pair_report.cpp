#include "tools/pair_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/pair_page.hpp"

namespace crosspatch {
namespace {

constexpr double kCoverageGate = 1 - 1e-9;  // rounding of summed areas
/// What a map of surfaces with holes has to cover of both: they need not be the same holes.
constexpr double kPartialCoverageGate = 0.9;

/// What of a map that was given by points could not be used as it is; empty if all could.
std::string torn_warning(const PointMapStatistics& s) {
  if (s.torn_source_triangles + s.turned_source_triangles + s.unmapped_source_vertices +
          s.target_vertices_without + s.unmapped_target_triangles ==
      0)
    return "";
  return fmt::format(
      "the given map is no continuous one: of {} source triangles {} are torn and {} turned over, "
      "{} source vertices are unmapped; {} target vertices have no source near, and {} of {} "
      "target "
      "triangles stay grey, {} of them torn",
      s.source_triangles,
      s.torn_source_triangles,
      s.turned_source_triangles,
      s.unmapped_source_vertices,
      s.target_vertices_without,
      s.unmapped_target_triangles,
      s.target_triangles,
      s.torn_target_triangles);
}

/// What makes a finished run end with kGateFailed, a sentence each.
std::vector<std::string> gate_failures(const PairRun& run) {
  const MapQuality& quality = run.matched.result.quality;
  std::vector<std::string> warnings;
  if (quality.flipped > 0)
    warnings.push_back(fmt::format("{} pieces of the map are turned over", quality.flipped));
  const bool partial = run.matched.is_partial();
  const double gate = partial ? kPartialCoverageGate : kCoverageGate;
  if (quality.source_coverage < gate || quality.target_coverage < gate)
    warnings.push_back(
        fmt::format("the map covers {:.2f} % of the source and {:.2f} % of the target",
                    100 * quality.source_coverage,
                    100 * quality.target_coverage));
  if (const std::string crumpled = crumpled_sentence(run.matched); !crumpled.empty())
    warnings.push_back(crumpled);
  if (run.from_points)
    if (const std::string torn = torn_warning(*run.from_points); !torn.empty())
      warnings.push_back(torn);
  if (!run.matched.valid)
    warnings.push_back("the map is not one-to-one: " + run.matched.valid.error().message);
  return warnings;
}

/// "1 hole and 2 handles"
std::string openings(int holes, int handles) {
  const auto counted = [](int n, const char* thing) {
    return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s");
  };
  if (handles == 0 && holes == 0) return "nothing";
  if (handles == 0) return counted(holes, "hole");
  if (holes == 0) return counted(handles, "handle");
  return counted(holes, "hole") + " and " + counted(handles, "handle");
}

std::string partial_warning(const MatchedMap& matched) {
  const auto [holes, handles] =
      std::pair(matched.holes[0] + matched.holes[1], matched.handles[0] + matched.handles[1]);
  return fmt::format(
      "{} of the source and {} of the target were {} for the map, which is one of parts: "
      "{:.2f} % of the source and {:.2f} % of the target are mapped",
      openings(matched.holes[0], matched.handles[0]),
      openings(matched.holes[1], matched.handles[1]),
      handles == 0 ? "closed" : (holes == 0 ? "cut" : "closed or cut"),
      100 * matched.result.quality.source_coverage,
      100 * matched.result.quality.target_coverage);
}

std::map<std::string, double> map_figures(const PairRun& run) {
  const MatchedMap& matched = run.matched;
  const MapResult& map = matched.result;
  const MapQuality& quality = map.quality;
  std::map<std::string, double> figures{{"flipped_triangles", quality.flipped},
                                        {"coverage", quality.target_coverage},
                                        {"source_coverage", quality.source_coverage},
                                        {"symmetric_dirichlet_mean", quality.mean},
                                        {"symmetric_dirichlet_median", quality.median},
                                        {"symmetric_dirichlet_90", quality.percentile_90},
                                        {"symmetric_dirichlet_99", quality.percentile_99},
                                        {"worst_stretch", quality.worst_stretch},
                                        {"overlay_points", map.map.point_count()},
                                        {"overlay_polygons", map.map.polygon_count()}};
  if (run.from_points) {
    const PointMapStatistics& s = *run.from_points;
    figures["map_torn_source_triangles"] = s.torn_source_triangles;
    figures["map_turned_source_triangles"] = s.turned_source_triangles;
    figures["map_unmapped_source_vertices"] = s.unmapped_source_vertices;
    figures["map_target_vertices_without_source"] = s.target_vertices_without;
    figures["map_torn_target_triangles"] = s.torn_target_triangles;
    figures["map_unmapped_target_triangles"] = s.unmapped_target_triangles;
  }
  if (matched.ranking.empty()) return figures;  // the map was given
  figures["initial_distortion"] = matched.ranking.front().distortion;
  figures["coarse_energy"] = matched.ranking.front().energy;
  figures["candidates"] = static_cast<double>(matched.ranking.size());
  figures["margin"] = matched.margin;
  figures["mirrored_margin"] = matched.mirrored_margin;
  if (matched.asymmetry) figures["asymmetry"] = *matched.asymmetry;
  figures["confidence"] = confidence(matched.margin, matched.result.quality, matched.asymmetry);
  for (std::size_t i = 0; i < matched.alternatives.size(); ++i)
    figures[fmt::format("margin_{}", i + 2)] = matched.alternatives[i].margin;
  return figures;
}

/// Why a map that was found is not sure, or nothing.
std::string doubt_sentence(const MatchedMap& matched) {
  const double energy = matched.result.quality.percentile_99;
  if (matched.ranking.empty() ||
      confidence(matched.margin, matched.result.quality, matched.asymmetry) >= 1)
    return "";
  if (!(matched.margin < kSafeMargin) && matched.asymmetry.value_or(0) > kSafeAsymmetry)
    return fmt::format(
        "the map tears pairs of the two bodies apart: left and right of one are {:.3f} from left "
        "and "
        "right of the other, up to {} is safe",
        *matched.asymmetry,
        kSafeAsymmetry);
  if (!(matched.margin < kSafeMargin))
    return fmt::format(
        "the two may not correspond everywhere: 1 % of the area is distorted beyond an energy of "
        "{:.0f}, up to {:.0f} is safe",
        energy,
        kSafeEnergy);
  // An isometry and another map as good as it differ by a symmetry. Bodies in two poses have
  // medians of 4.1 to 4.3.
  constexpr double kAsGood = 0.01, kNearIsometry = 4.5;
  if (matched.margin < kAsGood && matched.result.quality.median < kNearIsometry)
    return fmt::format(
        "the two are symmetric: another map fits as well, as if one were turned round (margin "
        "{:.3f}); a landmark tells which is meant",
        matched.margin);
  const char* sides = "";
  if (matched.mirrored_margin < kSafeMargin)
    sides = ", left and right may be exchanged";
  else if (std::isfinite(matched.mirrored_margin))
    sides = ", though not between left and right";
  return fmt::format(
      "the choice among the candidate maps is unsure{}: the margin is {:.3f}, {} is safe",
      sides,
      matched.margin,
      kSafeMargin);
}

}  // namespace

std::vector<InputSummary> input_summaries(const PairFiles& files, const PairRun& run) {
  return {summarize("source", files.source, run.source.soup, run.source.prepared),
          summarize("target", files.target, run.target.soup, run.target.prepared)};
}

RunReport pair_report(const PairArguments& arguments, const PairRun& run) {
  const PairFiles& files = arguments.files;
  RunReport report;
  report.inputs = input_summaries(files, run);
  for (const std::string& other : {files.landmarks, files.map})
    if (!other.empty()) report.other_inputs.push_back(other);
  report.quality = map_figures(run);
  report.warnings = gate_failures(run);
  report.exit_code =
      static_cast<int>(report.warnings.empty() ? ExitCode::kDone : ExitCode::kGateFailed);
  if (run.matched.is_partial()) report.warnings.push_back(partial_warning(run.matched));
  if (const std::string doubt = doubt_sentence(run.matched); !doubt.empty())
    report.warnings.push_back(doubt);
  return report;
}

Result<ExitCode> finish(std::vector<OutputFile> outputs,
                        RunReport report,
                        const CommonArguments& common,
                        const Progress& progress) {
  for (const OutputFile& output : outputs) report.outputs.push_back(output.path);
  report.stages = progress.records();
  report.options["seed"] = fmt::format("{}", common.seed);
  if (!common.json.empty()) outputs.push_back({common.json, report_json(report)});
  if (const Status written = write_output_files(outputs); !written)
    return tl::unexpected(written.error());
  if (common.verbose)
    for (const auto& [name, value] : report.quality) print_figure(name, value);
  for (const std::string& warning : report.warnings) print_warning(warning);
  return static_cast<ExitCode>(report.exit_code);
}

Result<ExitCode> finish(std::vector<OutputFile> outputs,
                        RunReport report,
                        const PairArguments& arguments,
                        const PairRun& run,
                        Progress& progress) {
  if (!arguments.report.empty()) {
    progress.begin("report");
    Result<std::string> page = pair_page(run, report);
    if (!page) return tl::unexpected(page.error());
    progress.end(fmt::format("{:.1f} MB", static_cast<double>(page->size()) / 1e6));
    outputs.push_back({arguments.report, std::move(*page)});
  }
  return finish(std::move(outputs), std::move(report), arguments.common, progress);
}

}  // namespace crosspatch
