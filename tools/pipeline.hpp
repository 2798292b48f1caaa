#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/spectral_matching.hpp"
#include "param/match.hpp"
#include "param/point_map.hpp"
#include "tools/input.hpp"
#include "tools/landmarks.hpp"
#include "tools/pair_files.hpp"
#include "tools/progress.hpp"

namespace crosspatch {

/// The largest number of stages up to the map that report progress.
constexpr int kMapStages = 8;

/// All that a run over a pair has made, stage by stage; later stages are empty where it stopped
/// before. A map that was given has no ranking.
struct PairRun {
  InputMesh source;
  InputMesh target;
  std::vector<Landmark> landmarks;  ///< vertices of the prepared meshes
  MatchedMap matched;               ///< from the source's prepared mesh to the target's
  /// What became of a map that was given by points; unset for others.
  std::optional<PointMapStatistics> from_points;
};

/// file -> soup -> mesh -> landmarks. kBadInput with the file's path.
Result<PairRun> read_pair(const PairFiles& files, Progress& progress);

/// Adds the map to a pair that has been read, see run_pair.
Status map_pair(const PairFiles& files, PairRun& run, Progress& progress);

/// file -> soup -> mesh -> landmarks -> map; the map is read where a file of one is given.
/// Errors are those of the stages, with the file's path where a file is to blame.
Result<PairRun> run_pair(const PairFiles& files, Progress& progress);

/// The paper's matching of a pair that has been read: its features matched by spectral matching.
Result<Matching> paper_matching(const PairRun& run, Progress& progress);

/// The critical points of both surfaces that the map of a finished run brings together, after the
/// landmarks that were given. Their confidence is that of match_nodes times that of the map; that
/// of landmarks is 1. kNoCorrespondence if there are none.
Result<Matching> judged_matching(const PairRun& run, Progress& progress);

/// A map that was found is *sure* from this margin of the finals on, if 99 % of it stay below
/// kSafeEnergy and its asymmetry below kSafeAsymmetry. Chosen on FAUST, SMAL, SHREC'07 and the
/// gorillas and humans of TOSCA, where 99 of 140 pairs are sure and the mean error of 98 of them is
/// below 10 % of the square root of the area; see docs/benchmarks.md.
constexpr double kSafeMargin = 0.08;

/// Energy that 99 % of a sure map stay below, a stretch of ten: beyond it one surface has parts
/// that the other lacks, or the two are not alike at all.
constexpr double kSafeEnergy = 100;

/// Asymmetry (see MatchedMap) of a sure map at most: right maps of four-legged animals, whose poses
/// make reflections inexact, have up to 0.08, and wrong ones 0.1 and more.
constexpr double kSafeAsymmetry = 0.1;

/// How far a map that was found can be trusted, in [0, 1]: 1 is sure. The least of the margin over
/// kSafeMargin, of kSafeEnergy over the energy that 99 % stay below and of kSafeAsymmetry over the
/// asymmetry, where that is known.
double confidence(double margin, const MapQuality& quality, std::optional<double> asymmetry = {});

/// Energy (|J|^2 + |J^-1|^2; isometry: 4) that 99 % of a map that was found may reach: beyond it, a
/// stretch of thirty, surfaces were forced on each other that do not correspond. The right maps of
/// all sets that were tried stay below 360.
constexpr double kMostEnergy = 1000;

/// Says by how much a found map exceeds kMostEnergy; empty where it does not, and for given maps.
std::string crumpled_sentence(const MatchedMap& matched);

/// The landmarks as vertices of the prepared meshes. Pairs that repeat another after welding are
/// dropped. kBadInput with the file's vertex: it belongs to a part that was left out, or welding
/// gives it two partners.
Result<std::vector<Landmark>> mesh_landmarks(const std::vector<FileLandmark>& landmarks,
                                             const PreparedMesh& source,
                                             const PreparedMesh& target);

}  // namespace crosspatch
