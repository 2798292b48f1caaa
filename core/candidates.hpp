#pragma once

#include <utility>
#include <vector>

#include "core/features.hpp"

namespace crosspatch {

/// What a proposal looks at: the tips of one surface.
struct TipDescriptors {
  Eigen::MatrixXd signature;  ///< tips x channels
  Eigen::MatrixXd distance;   ///< tips x tips, symmetric

  [[nodiscard]] int count() const { return static_cast<int>(distance.rows()); }
};

/// Logarithms of the wave kernel signature at the tips of `features`, and geodesic distances
/// between them, divided by their mean: proportions rather than lengths. Against log-HKS and plain
/// distances this took the truth into the first 20 of its class on 10 of 10 SHREC'07 four-legged
/// pairs (from 7) and 32 of 32 SMAL pairs (from 26).
TipDescriptors tip_descriptors(const ShapeFeatures& features);

/// A one-to-one assignment of some tips.
struct TipAssignment {
  std::vector<std::pair<int, int>> pairs;  ///< (source tip, target tip), by source tip
  double cost = 0;                         ///< see propose; 0 = alike in every respect
};

struct ProposalOptions {
  /// Assignments returned.
  int keep = 150;
  /// Part of `keep` for assignments that leave out no tip, the rest for those that leave out one;
  /// what one class cannot fill goes to the other. Measured: the truth is among the first 20 of the
  /// first class, and of the second among the first 20 in 27 and the first 40 in 29 of 32 pairs.
  double full_share = 0.4;
  /// Weight of the mean difference of signatures (a mean over the channels); 0.6 to 1.2 did equally
  /// well, below it the ranking gets worse.
  double signature_weight = 0.8;
  /// Weight of the mean |d1 - d2| / (d1 + d2) over pairs of assigned tips.
  double distance_weight = 4;
  /// Cost of leaving out all tips that could be assigned; one of k costs a k-th of it.
  double skip_weight = 0.6;
  /// Assignments may leave out one tip, an outlier, if at least this many pairs are left: fewer say
  /// nothing about a surface.
  int least_pairs = 3;
  /// The first `fixed` tips of both surfaces are landmarks: the i-th goes to the i-th in every
  /// assignment, and their distances say where the others belong.
  int fixed = 0;
  /// Per tip the one that a reflection of its surface exchanges it with (itself if it stays), -1 if
  /// that is not known. Where both are given, assignments must take exchanged tips to exchanged
  /// ones and those that stay to those that stay, and may leave out any number of tips beyond
  /// `least_pairs`.
  std::vector<int> source_partner = {}, target_partner = {};
  /// Partial assignments kept a step when there are too many to try them all.
  int beam = 3000;
};

/// Proposes assignments of k and of k - 1 tips, where k is the smaller count of tips, by rising
/// cost (ties by target indices). All of them are tried up to about 7 tips, beyond that those a
/// beam search keeps. All are different. Empty if a surface has no tip. The order is a weak hint
/// only: mirrored and swapped limbs cost about the same, so the choice must be made by the maps.
/// Cost: at most n^3 * beam for n tips.
std::vector<TipAssignment> propose(const TipDescriptors& source,
                                   const TipDescriptors& target,
                                   const ProposalOptions& options = {});

}  // namespace crosspatch
