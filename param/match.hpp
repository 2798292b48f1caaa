#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/candidates.hpp"
#include "param/judge.hpp"
#include "param/make_map.hpp"

namespace crosspatch {

struct MatchOptions {
  FeatureOptions features = {};
  ProposalOptions proposal = {};
  JudgeOptions judge = {};
  MapOptions map = {};
  ShapeOptions shape = {};
  /// This many landmarks decide the map alone; fewer are joined with proposed tips, so that no limb
  /// is left without a guide.
  int enough_landmarks = 16;
  /// Other maps that are finished too, at most; see MatchedMap::alternatives.
  int alternatives = 0;
  /// Called with the name of each stage when it begins; may be empty.
  std::function<void(const std::string&)> progress = {};
};

/// A map that was not chosen.
struct Alternative {
  std::vector<Landmark> landmarks;  ///< of the candidate it was made for
  double margin = 0;                ///< its energy in the finals minus the winner's
  MapResult result;
};

/// A map with all that led to it.
struct MatchedMap {
  std::vector<Candidate> ranking;  ///< by the finals and the judge; ranking[0] was mapped
  double margin = 0;  ///< Verdict::margin; 0 if the winner could not be refined and a rival was
  double mirrored_margin = 0;  ///< Verdict::mirrored_margin, likewise
  /// See asymmetry(), of the coarse map that was chosen; empty where reflections are not to be
  /// believed or nobody asked.
  std::optional<double> asymmetry = {};
  MapResult result;
  /// Other ways to see it: finished maps of the finals, best first, of which each lies farther than
  /// kSameMap from the winner and from those before it.
  std::vector<Alternative> alternatives;
  /// Boundary loops of the source and of the target that were closed for the map and opened again,
  /// without a partner whose rim theirs is taken to.
  std::array<int, 2> holes{0, 0};
  /// Handles of the source and of the target that were cut through for the map, which does not go
  /// on across the cuts.
  std::array<int, 2> handles{0, 0};
  /// Whether the map is a bijection, of the surfaces or, with holes or handles, of the parts that
  /// it covers once these are cut; the error says what is wrong.
  Status valid;

  [[nodiscard]] bool is_partial() const {
    return holes[0] + holes[1] + handles[0] + handles[1] > 0;
  }
};

/// Finds the map of two surfaces: cuts their handles, closes their boundary loops, proposes
/// assignments of their tips, judges them by their bijective maps, optimises the winner and joins
/// it again across cuts and at rims. `given` landmarks are exact in the result; found ones are
/// released in the end. kNoCorrespondence: no candidate has a map. Other errors are those of the
/// stages.
Result<MatchedMap> match_and_map(const TriangleMesh& source,
                                 const TriangleMesh& target,
                                 const std::vector<Landmark>& given,
                                 const MatchOptions& options = {});

}  // namespace crosspatch
