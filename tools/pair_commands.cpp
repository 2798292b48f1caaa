// crosspatch match and map: a run over a pair, then its outputs.
#include <fmt/format.h>

#include <filesystem>

#include "tools/commands.hpp"
#include "tools/map_text.hpp"
#include "tools/overlay_text.hpp"
#include "tools/pair_report.hpp"

namespace crosspatch {
namespace {

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

/// `path` for the map with this number, from 1: the first has the name that was asked for.
std::string numbered(const std::string& path, int number) {
  if (number == 1) return path;
  std::filesystem::path name(path);
  const std::string extension = name.extension().string();
  name.replace_extension();
  return fmt::format("{}_{}{}", name.string(), number, extension);
}

std::vector<OutputFile> map_outputs(const MapArguments& arguments,
                                    const PairRun& run,
                                    const SurfaceMap& map,
                                    int number) {
  const PreparedMesh &source = run.source.prepared, &target = run.target.prepared;
  std::vector<OutputFile> outputs = {
      {numbered(arguments.output, number), map_text(map_of_file_vertices(map, source, target))}};
  if (!arguments.inverse.empty())
    outputs.push_back({numbered(arguments.inverse, number),
                       map_text(map_of_file_vertices(inverse(map), target, source))});
  if (!arguments.overlay.empty())
    outputs.push_back({numbered(arguments.overlay, number), overlay_text(map, source, target)});
  return outputs;
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
  Progress progress(arguments.pair.common.quiet, kMapStages + 1);
  const Result<PairRun> run = run_pair(arguments.pair.files, progress);
  if (!run) return tl::unexpected(run.error());
  const Result<Matching> matching = judged_matching(*run, progress);
  if (!matching) return tl::unexpected(matching.error());
  RunReport report = pair_report(arguments.pair, *run);
  report.command = "match";
  report.options = {{"method", "default"}};
  report.quality["matches"] = static_cast<double>(matching->matches.size());
  return finish(
      {{arguments.output, matching_text(*matching, run->source.prepared, run->target.prepared)}},
      std::move(report),
      arguments.pair,
      *run,
      progress);
}

Result<ExitCode> run(const MapArguments& arguments) {
  Progress progress(arguments.pair.common.quiet, kMapStages);
  const Result<PairRun> run = run_pair(arguments.pair.files, progress);
  if (!run) return tl::unexpected(run.error());
  std::vector<OutputFile> outputs = map_outputs(arguments, *run, run->matched.result.map, 1);
  int number = 1;
  for (const Alternative& other : run->matched.alternatives)
    for (OutputFile& file : map_outputs(arguments, *run, other.result.map, ++number))
      outputs.push_back(std::move(file));
  RunReport report = pair_report(arguments.pair, *run);
  report.command = "map";
  return finish(std::move(outputs), std::move(report), arguments.pair, *run, progress);
}

}  // namespace crosspatch
