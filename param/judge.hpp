#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "param/sphere_map.hpp"

namespace crosspatch {

/// One proposed correspondence of a few points, and what the bijective map through them costs.
struct Candidate {
  std::vector<Landmark> landmarks;
  /// What speaks against it before any map is made, in units of the distortion; the judge adds it.
  double prior = 0;
  double distortion = 0;  ///< disc_distortion of the best chain; infinite if none could be cut
  /// What is left when the coarse map is optimised: its SphereMap::coarse_distortion plus a share
  /// of the logarithm of its energy, less a share of its SphereMap::coarse_chirality, and the
  /// penalty of play_finals. Infinite without a map.
  double energy = 0;
};

/// How many pairs of landmarks `b` exchanges against `a`, as the other side of a body does with its
/// limbs; 0 where the two are about different vertices or differ by anything else.
int exchanged_pairs(const Candidate& a, const Candidate& b);

struct JudgeOptions {
  int chains = 2;  ///< tried for every candidate; Source: one to five change the winner in a few
                   ///< percent of pairs
  int finalists = 12;  ///< tried again with `final_chains`
  int final_chains = 12;
  /// Initial maps that go to the finals: the best of every finalist and, while there is room, maps
  /// along their other chains, which may belong to other homotopy classes.
  int finals = 14;
  /// The mirrored candidates (those that exchange most pairs) of so many that lead are finalists
  /// too, and their maps go to the finals besides the others: which side is the right one is hard
  /// to tell before the maps are optimised.
  int leaders = 3;
};

struct Final {
  std::size_t candidate;  ///< its place in the ranking
  InitialMap initial;
};

struct Judgement {
  std::vector<Candidate> ranking;  ///< by distortion (ties by order given)
  std::vector<Final> finals;
};

/// Builds the unoptimised bijective map of every candidate on the coarse levels and ranks them by
/// its distortion, the mean over both directions of the mean logarithm of the symmetric Dirichlet
/// energy. `candidates` are given in the order of their plausibility. Maps keep orientation, so
/// mirrored and swapped assignments pay with twists. kNoCorrespondence if no candidate has a map.
Result<Judgement> judge(const Shape& source,
                        const Shape& target,
                        std::vector<Candidate> candidates,
                        const JudgeOptions& options = {});

/// Candidate::energy of a coarse map whose optimisation ended with this mean energy.
double judged_energy(const SphereMap& map, double mean_energy);

/// Mean distance on the target, in sqrt(area), up to which two coarse maps count as one: what leads
/// to the same map in the end is no rival.
constexpr double kSameMap = 0.05;

/// What the finals decide.
struct Verdict {
  std::vector<Candidate> ranking;  ///< finalists by energy, then the others by distortion
  struct CoarseMap {
    std::unique_ptr<SphereMap> map;
    double energy = 0;                ///< see Candidate::energy
    std::vector<Landmark> landmarks;  ///< of the candidate it was made for
  };
  /// Coarse maps that were optimised to the end, by energy; the first is that of ranking[0].
  std::vector<CoarseMap> maps;
  /// Energy of the best final whose map is another one (farther than kSameMap) minus the winner's;
  /// infinite if there is none.
  double margin = 0;
  /// The same over the finals of candidates that exchange pairs of the winner's landmarks and
  /// change nothing else.
  double mirrored_margin = 0;
};

/// Optimises the coarse maps of the finalists and ranks them by what is left of the energy: the
/// unoptimised map tells what is wrong by far, the optimised one what is better. A body whose two
/// sides are alike has a mirrored map that costs as little; the chirality fields tell them apart.
/// All are optimised roughly first, and only the best that differ from each other to the end.
/// `penalty` is added to the energy of every map; it may be called from several threads.
/// kNoCorrespondence if none can be optimised. Shapes must outlive the verdict.
Result<Verdict> play_finals(const Shape& source,
                            const Shape& target,
                            Judgement judgement,
                            const MapOptions& options,
                            const std::function<double(const SphereMap&)>& penalty = {});

}  // namespace crosspatch
