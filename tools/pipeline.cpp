#include "tools/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "core/cut_handles.hpp"
#include "param/map_quality.hpp"
#include "param/node_matching.hpp"
#include "tools/overlay_text.hpp"
#include "tools/point_map_text.hpp"
#include "tools/source_texture.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// Least persistence of the critical points that `match` names, on log ADF.
constexpr double kDetail = 0.005;

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

Result<MatchedMap> find_map(const PairRun& run, const PairFiles& files, Progress& progress) {
  MatchOptions options;
  options.alternatives = files.alternatives;
  options.progress = [&progress](const std::string& stage) { progress.begin(stage); };
  return match_and_map(run.source.prepared.mesh, run.target.prepared.mesh, run.landmarks, options)
      .and_then([&](MatchedMap matched) -> Result<MatchedMap> {
        if (const std::string crumpled = crumpled_sentence(matched);
            !crumpled.empty() && !files.force)
          return fail(ErrorCode::kNoCorrespondence, crumpled + "; --force goes on with it");
        return matched;
      });
}

/// Says whether a map that was given is a bijection of the surfaces, else of parts that end at
/// their holes, else of such parts of what is left of them when their handles are cut.
void check_given(MatchedMap& matched, const TriangleMesh& source, const TriangleMesh& target) {
  const SurfaceMap& map = matched.result.map;
  matched.valid = validate(map, source, target);
  if (matched.valid) return;
  const std::array<int, 2> handles{genus(source), genus(target)};
  const std::array<int, 2> holes{static_cast<int>(boundary_loops(source).size()),
                                 static_cast<int>(boundary_loops(target).size())};
  if (holes[0] + holes[1] > 0 && validate_partial(map, source, target)) {
    matched.holes = holes;
    matched.valid = {};
  } else if (handles[0] + handles[1] > 0) {
    matched.handles = handles;
    matched.holes = holes;
    matched.valid = cut_handles(source).and_then([&](const CutMesh& a) {
      return cut_handles(target).and_then(
          [&](const CutMesh& b) { return validate_partial(map, a.mesh, b.mesh); });
    });
  }
}

/// The map that a file gives: exact, or by points, which leave `from_points` behind.
Result<SurfaceMap> parse_given(const std::string& text, int base, PairRun& run) {
  const PreparedMesh &source = run.source.prepared, &target = run.target.prepared;
  if (is_overlay_text(text)) {
    if (base != 0) return fail(ErrorCode::kBadInput, "an overlay counts from 0, not from 1");
    return parse_overlay(text, source, target);
  }
  return parse_point_map(text, base, source, target)
      .and_then([&](const std::vector<SurfacePoint>& images) {
        return map_from_points(source.mesh, target.mesh, images);
      })
      .map([&](PointMap map) {
        run.from_points = map.statistics;
        return std::move(map.map);
      });
}

Result<MatchedMap> read_map(const PairFiles& files, PairRun& run, Progress& progress) {
  progress.begin("map");
  const TriangleMesh &source = run.source.prepared.mesh, &target = run.target.prepared.mesh;
  return read_input_text(files.map)
      .and_then([&](const std::string& text) { return parse_given(text, files.map_base, run); })
      .map([&](SurfaceMap map) {
        MatchedMap matched;
        matched.margin = matched.mirrored_margin = std::numeric_limits<double>::infinity();
        matched.result.quality = measure_map(map, source, target);
        if (run.from_points)
          matched.result.quality.source_coverage = run.from_points->source_coverage;
        matched.result.map = std::move(map);
        check_given(matched, source, target);
        return matched;
      })
      .map_error([&](const Error& error) { return with_path(files.map, error); });
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

/// What the paper's matchers look at of one surface.
Result<MatchingShape> paper_shape(const TriangleMesh& mesh) {
  return compute_features(mesh).and_then(
      [&](const ShapeFeatures& features) { return matching_shape(mesh, features); });
}

/// The critical points that are matched over a map, finer than the tips it was found by.
Result<MorseSmaleComplex> detailed_complex(const TriangleMesh& mesh) {
  return compute_spectrum(mesh).and_then([&](const Spectrum& spectrum) {
    return morse_smale_complex(
        mesh, auto_diffusion(spectrum), {.threshold = kDetail, .scale = FieldScale::kLog});
  });
}

}  // namespace

double confidence(double margin, const MapQuality& quality, std::optional<double> asymmetry) {
  return std::clamp(std::min({margin / kSafeMargin,
                              kSafeEnergy / quality.percentile_99,
                              kSafeAsymmetry / std::max(asymmetry.value_or(0), 1e-12)}),
                    0.0,
                    1.0);
}

std::string crumpled_sentence(const MatchedMap& matched) {
  const double energy = matched.result.quality.percentile_99;
  if (matched.ranking.empty() || !(energy > kMostEnergy)) return "";
  return fmt::format(
      "no trustworthy map: 1 % of the area is distorted beyond an energy of {:.3g}, {:.0f} is the "
      "most",
      energy,
      kMostEnergy);
}

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

Result<PairRun> read_pair(const PairFiles& files, Progress& progress) {
  PairRun run;
  Result<InputMesh> source = read_stage("source", files.source, progress);
  if (!source) return tl::unexpected(source.error());
  run.source = std::move(*source);
  if (!files.texture.empty())
    if (Status s = give_texture(files.texture, run.source.soup); !s)
      return tl::unexpected(s.error());
  Result<InputMesh> target = read_stage("target", files.target, progress);
  if (!target) return tl::unexpected(target.error());
  run.target = std::move(*target);
  if (files.landmarks.empty()) return run;
  Result<std::vector<Landmark>> landmarks = read_landmarks(files.landmarks, run.source, run.target);
  if (!landmarks) return tl::unexpected(landmarks.error());
  run.landmarks = std::move(*landmarks);
  return run;
}

Status map_pair(const PairFiles& files, PairRun& run, Progress& progress) {
  Result<MatchedMap> matched =
      files.map.empty() ? find_map(run, files, progress) : read_map(files, run, progress);
  if (!matched) return tl::unexpected(matched.error());
  run.matched = std::move(*matched);
  if (files.texture == "distortion")
    color_by_distortion(
        run.source.prepared.numbering,
        vertex_distortion(
            run.matched.result.map, run.source.prepared.mesh, run.target.prepared.mesh)
            .source,
        run.source.soup);
  progress.end(map_summary(run.matched));
  return {};
}

Result<PairRun> run_pair(const PairFiles& files, Progress& progress) {
  Result<PairRun> run = read_pair(files, progress);
  if (!run) return run;
  if (Status s = map_pair(files, *run, progress); !s) return tl::unexpected(s.error());
  return run;
}

Result<Matching> paper_matching(const PairRun& run, Progress& progress) {
  progress.begin("features");
  const Result<MatchingShape> source = paper_shape(normalized(run.source.prepared.mesh));
  if (!source) return tl::unexpected(source.error());
  const Result<MatchingShape> target = paper_shape(normalized(run.target.prepared.mesh));
  if (!target) return tl::unexpected(target.error());
  progress.end(fmt::format(
      "{} and {} critical points", source->graph.node_count(), target->graph.node_count()));
  progress.begin("match");
  Result<Matching> matching = spectral_matching(*source, *target);
  if (matching) progress.end(fmt::format("{} matches", matching->matches.size()));
  return matching;
}

Result<Matching> judged_matching(const PairRun& run, Progress& progress) {
  progress.begin("match");
  const TriangleMesh &source = run.source.prepared.mesh, &target = run.target.prepared.mesh;
  const Result<MorseSmaleComplex> a = detailed_complex(source);
  if (!a) return tl::unexpected(a.error());
  const Result<MorseSmaleComplex> b = detailed_complex(target);
  if (!b) return tl::unexpected(b.error());
  Matching matching;
  std::set<int> given_source, given_target;
  for (const Landmark& landmark : run.landmarks) {
    matching.matches.push_back(
        {NodeKind::kMaximum, landmark.source_vertex, landmark.target_vertex, 1});
    given_source.insert(landmark.source_vertex);
    given_target.insert(landmark.target_vertex);
  }
  const double trust =
      confidence(run.matched.margin, run.matched.result.quality, run.matched.asymmetry);
  for (Match match : match_nodes(source, target, *a, *b, run.matched.result.map).matches) {
    if (given_source.contains(match.source_vertex) || given_target.contains(match.target_vertex))
      continue;
    match.confidence *= trust;
    matching.matches.push_back(match);
  }
  if (matching.matches.empty())
    return fail(ErrorCode::kNoCorrespondence,
                fmt::format("match: the map brings none of {} and {} critical points together",
                            a->nodes.size(),
                            b->nodes.size()));
  std::sort(matching.matches.begin(), matching.matches.end(), [](const Match& x, const Match& y) {
    return std::tuple(-x.confidence, x.source_vertex, x.kind) <
           std::tuple(-y.confidence, y.source_vertex, y.kind);
  });
  progress.end(fmt::format("{} matches", matching.matches.size()));
  return matching;
}

}  // namespace crosspatch
