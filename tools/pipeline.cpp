#include "tools/pipeline.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace crosspatch {
namespace {

using std::size_t;

/// What is said about an input when it has been read: its size and what had to be repaired.
std::string read_summary(const InputMesh& input) {
  std::string text = fmt::format("{} triangles", input.prepared.mesh.face_count());
  for (const std::string& repair : input.prepared.repairs) text += "; " + repair;
  return text;
}

Result<InputMesh> read_stage(const char* role, const std::string& path, Progress& progress) {
  progress.begin(role);
  Result<InputMesh> input = read_input(path);
  if (input) progress.end(read_summary(*input));
  return input;
}

Result<std::vector<Landmark>> read_landmarks(const std::string& path,
                                             const InputMesh& source,
                                             const InputMesh& target) {
  const Result<std::string> text = read_input_text(path);
  if (!text) return tl::unexpected(text.error());
  return parse_landmarks(*text,
                         static_cast<int>(source.soup.positions.rows()),
                         static_cast<int>(target.soup.positions.rows()))
      .and_then([&](const std::vector<FileLandmark>& landmarks) {
        return mesh_landmarks(landmarks, source.prepared, target.prepared);
      })
      .map_error([&](const Error& error) { return with_path(path, error); });
}

Result<MatchedMap> find_map(const PairRun& run, Progress& progress) {
  MatchOptions options;
  options.progress = [&progress](const std::string& stage) { progress.begin(stage); };
  return match_and_map(normalized(run.source.prepared.mesh),
                       normalized(run.target.prepared.mesh),
                       run.landmarks,
                       options);
}

std::string map_summary(const MatchedMap& matched) {
  const MapQuality& quality = matched.result.quality;
  const std::string margin =
      std::isfinite(matched.margin) ? fmt::format(", margin {:.3f}", matched.margin) : "";
  return fmt::format("median energy {:.2f} (isometry 4), {} flipped, {:.1f} % covered{}",
                     quality.median,
                     quality.flipped,
                     100 * quality.target_coverage,
                     margin);
}

}  // namespace

Result<std::vector<Landmark>> mesh_landmarks(const std::vector<FileLandmark>& landmarks,
                                             const PreparedMesh& source,
                                             const PreparedMesh& target) {
  std::map<int, int> target_of, source_of;
  std::vector<Landmark> result;
  for (const FileLandmark& pair : landmarks) {
    const Landmark landmark{source.numbering.mesh_vertex[static_cast<size_t>(pair.source_vertex)],
                            target.numbering.mesh_vertex[static_cast<size_t>(pair.target_vertex)]};
    if (landmark.source_vertex < 0 || landmark.target_vertex < 0) {
      const bool source_lost = landmark.source_vertex < 0;
      return fail(ErrorCode::kBadInput,
                  fmt::format("{} vertex {} lies in no part of the mesh that is mapped",
                              source_lost ? "source" : "target",
                              source_lost ? pair.source_vertex : pair.target_vertex));
    }
    const auto [to, new_source] =
        target_of.try_emplace(landmark.source_vertex, landmark.target_vertex);
    const auto [from, new_target] =
        source_of.try_emplace(landmark.target_vertex, landmark.source_vertex);
    if (to->second != landmark.target_vertex || from->second != landmark.source_vertex)
      return fail(ErrorCode::kBadInput,
                  fmt::format("pair {} {}: one of the two already has another partner at the same "
                              "place",
                              pair.source_vertex,
                              pair.target_vertex));
    if (new_source && new_target) result.push_back(landmark);
  }
  return result;
}

Result<PairRun> run_pair(const PairFiles& files, LastStage last, Progress& progress) {
  PairRun run;
  Result<InputMesh> source = read_stage("source", files.source, progress);
  if (!source) return tl::unexpected(source.error());
  run.source = std::move(*source);
  Result<InputMesh> target = read_stage("target", files.target, progress);
  if (!target) return tl::unexpected(target.error());
  run.target = std::move(*target);
  if (!files.landmarks.empty()) {
    Result<std::vector<Landmark>> landmarks =
        read_landmarks(files.landmarks, run.source, run.target);
    if (!landmarks) return tl::unexpected(landmarks.error());
    run.landmarks = std::move(*landmarks);
  }

  Result<MatchedMap> matched = find_map(run, progress);
  if (!matched) return tl::unexpected(matched.error());
  run.matched = std::move(*matched);
  progress.end(map_summary(run.matched));
  if (last == LastStage::kMap) return run;

  progress.begin("transfer");
  Result<CarriedTexture> carried = carry_texture({run.source.prepared, run.source.soup},
                                                 {run.target.prepared, run.target.soup},
                                                 run.matched.result.map);
  if (!carried) return tl::unexpected(carried.error());
  run.carried = std::move(*carried);
  progress.end(fmt::format("{} triangles, {} seam cuts",
                           run.carried.statistics.triangles,
                           run.carried.statistics.seam_cuts));
  return run;
}

}  // namespace crosspatch
