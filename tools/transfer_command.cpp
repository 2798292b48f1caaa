// crosspatch transfer: a map, found or given, and the texture carried over it.
#include <fmt/format.h>

#include <filesystem>
#include <iterator>

#include "tools/attributes.hpp"
#include "tools/commands.hpp"
#include "tools/motion.hpp"
#include "tools/pair_report.hpp"
#include "transfer/bake.hpp"
#include "transfer/carry_texture.hpp"
#include "transfer/round_trip.hpp"
#include "transfer/write_mesh_files.hpp"

namespace crosspatch {
namespace {

std::map<std::string, double> keep_figures(const CarryTextureStatistics& statistics) {
  return {{"coverage", statistics.coverage},
          {"triangles", statistics.triangles},
          {"seam_cuts", statistics.seam_cuts},
          {"overlay_triangles", statistics.overlay_triangles},
          {"max_uv_error_texels", statistics.max_uv_error_texels},
          {"max_color_error", statistics.max_color_error},
          {"unmapped_faces", statistics.unmapped_faces},
          {"degenerate_polygons", statistics.degenerate_polygons}};
}

std::map<std::string, double> bake_figures(const BakeStatistics& s) {
  std::map<std::string, double> figures{{"coverage", s.coverage},
                                        {"own_unwrap", s.own_unwrap ? 1 : 0},
                                        {"charts", s.charts},
                                        {"overlay_triangles", s.overlay_triangles},
                                        {"texels_filled", s.texels_filled},
                                        {"image_used", s.used},
                                        {"texel_density_ratio", s.density_ratio[0]},
                                        {"texel_density_ratio_5", s.density_ratio[1]},
                                        {"texel_density_ratio_95", s.density_ratio[2]}};
  for (std::size_t level = 0; level < s.seam_error.size(); ++level)
    figures[fmt::format("seam_error_mip_{}", level)] = s.seam_error[level];
  return figures;
}

/// A mesh with its texture, and what is told about how it was made.
struct Transferred {
  TexturedMesh mesh;
  std::map<std::string, double> figures;
  std::string summary;
  std::string warning{};
};

Result<Transferred> keep(const TransferArguments& arguments, const PairRun& run) {
  CarryTextureOptions options;
  options.uv_tolerance_texels = arguments.uv_tolerance_texels;
  auto carried = carry_texture({run.source.prepared, run.source.soup},
                               {run.target.prepared, run.target.soup},
                               run.matched.result.map,
                               options);
  if (!carried) return tl::unexpected(carried.error());
  const CarryTextureStatistics& s = carried->statistics;
  return Transferred{std::move(carried->mesh),
                     keep_figures(s),
                     fmt::format("{} triangles, {} seam cuts", s.triangles, s.seam_cuts)};
}

/// Adds the figures of the round trip, or tells why there are none.
std::string add_round_trip(const PairRun& run,
                           const TexturedMesh& baked,
                           std::map<std::string, double>& figures) {
  const auto trip = round_trip({run.source.prepared, run.source.soup},
                               {run.target.prepared, run.target.soup},
                               run.matched.result.map,
                               baked);
  if (!trip) return "no round trip was measured, as of the source " + trip.error().message;
  figures["round_trip_psnr"] = trip->similarity.psnr;
  figures["round_trip_ssim"] = trip->similarity.ssim;
  figures["round_trip_size"] = trip->size;
  figures["round_trip_covered"] = trip->covered;
  return "";
}

Result<Transferred> bake(const TransferArguments& arguments, const PairRun& run) {
  BakeOptions options;
  options.size = arguments.size;
  options.encoding.format = arguments.image_format;
  options.encoding.bits = arguments.bits;
  auto baked = bake_texture({run.source.prepared, run.source.soup},
                            {run.target.prepared, run.target.soup},
                            run.matched.result.map,
                            options);
  if (!baked) return tl::unexpected(baked.error());
  const BakeStatistics& s = baked->statistics;
  std::map<std::string, double> figures = bake_figures(s);
  std::string warning;
  if (arguments.round_trip) warning = add_round_trip(run, baked->mesh, figures);
  const std::string where =
      s.own_unwrap
          ? "over the target's texture coordinates"
          : fmt::format("over {} charts (the target's texture coordinates do not serve: {})",
                        s.charts,
                        s.why_not_own);
  return Transferred{std::move(baked->mesh),
                     std::move(figures),
                     fmt::format("{0} x {0} texels {1}, {2:.2f} % filled, seams {3:.1f}/255",
                                 options.size,
                                 where,
                                 100 * s.texels_filled,
                                 s.seam_error[0]),
                     warning};
}

/// The files of the mesh, beside each other.
Result<std::vector<OutputFile>> mesh_outputs(const TexturedMesh& mesh, const std::string& path) {
  const std::filesystem::path output(path);
  Result<std::vector<NamedBytes>> encoded = encode_mesh_files(mesh, output.filename().string());
  if (!encoded) return tl::unexpected(encoded.error());
  std::vector<OutputFile> outputs;
  for (NamedBytes& file : *encoded)
    outputs.push_back({(output.parent_path() / file.name).string(), std::move(file.bytes)});
  return outputs;
}

std::map<std::string, std::string> options_in_force(const TransferArguments& arguments) {
  std::map<std::string, std::string> options;
  const bool bakes = arguments.mode == TransferMode::kBake;
  options["mode"] = bakes ? "bake" : "keep";
  if (!bakes) options["uv_tolerance"] = fmt::format("{}", arguments.uv_tolerance_texels);
  if (bakes) options["size"] = fmt::format("{}", arguments.size);
  if (bakes) options["bits"] = fmt::format("{}", arguments.bits);
  if (arguments.skin) options["skin"] = "true";
  if (arguments.morphs) options["morphs"] = "true";
  if (!arguments.pair.files.texture.empty()) options["texture"] = arguments.pair.files.texture;
  return options;
}

}  // namespace

Result<ExitCode> run(const TransferArguments& arguments) {
  const PairFiles& files = arguments.pair.files;
  Progress progress(arguments.pair.common.quiet, kMapStages + 2);
  Result<PairRun> run = read_pair(files, progress);
  if (!run) return tl::unexpected(run.error());
  const std::vector<AttributeFiles> attribute_paths =
      attribute_files(arguments.attributes, arguments.attributes_output, arguments.output);
  const Result<std::vector<Attributes>> attributes = read_attributes(attribute_paths, run->source);
  if (!attributes) return tl::unexpected(attributes.error());
  const MotionParts parts{.skin = arguments.skin, .morphs = arguments.morphs};
  const Result<SourceMotion> motion = read_motion(files.source, run->source, parts);
  if (!motion) return tl::unexpected(motion.error());
  if (Status s = map_pair(files, *run, progress); !s) return tl::unexpected(s.error());
  progress.begin("transfer");
  Result<Transferred> result =
      arguments.mode == TransferMode::kBake ? bake(arguments, *run) : keep(arguments, *run);
  if (!result) return tl::unexpected(result.error());
  const Result<MotionOutcome> moved = move_mesh(*motion, *run, result->mesh);
  if (!moved) return tl::unexpected(moved.error());
  Result<std::vector<OutputFile>> outputs = mesh_outputs(result->mesh, arguments.output);
  if (!outputs) return tl::unexpected(outputs.error());
  progress.end(result->summary + moved->summary);
  RunReport report = pair_report(arguments.pair, *run);
  report.command = "transfer";
  report.options = options_in_force(arguments);
  for (const auto& [name, value] : result->figures) report.quality[name] = value;
  if (!result->warning.empty()) report.warnings.push_back(result->warning);
  report.quality.insert(moved->figures.begin(), moved->figures.end());
  report.warnings.insert(report.warnings.end(), moved->warnings.begin(), moved->warnings.end());
  if (!attribute_paths.empty()) {
    progress.begin("attributes");
    CarriedAttributes carried = carry_attributes(
        attribute_paths, *attributes, run->source, run->target, run->matched.result.map);
    progress.end(carried.summary);
    std::move(carried.outputs.begin(), carried.outputs.end(), std::back_inserter(*outputs));
    report.quality.insert(carried.figures.begin(), carried.figures.end());
    if (!carried.warning.empty()) report.warnings.push_back(carried.warning);
    for (const AttributeFiles& paths : attribute_paths) report.other_inputs.push_back(paths.input);
  }
  return finish(std::move(*outputs), std::move(report), arguments.pair, *run, progress);
}

}  // namespace crosspatch
