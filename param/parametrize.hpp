#pragma once

#include "core/mesh.hpp"

namespace crosspatch {

enum class PatchBoundary {
  kFixed,    ///< boundary vertices stay where they start
  kSliding,  ///< those inside a straight side slide along it; those where it turns stay
  kFree,     ///< all move; the image may then overlap itself, though no triangle turns over
};

struct ParametrizeOptions {
  PatchBoundary boundary = PatchBoundary::kFixed;
  int max_rounds = 100;     ///< 10-20 are usual, 60 from starts with areas 1e-6 too small
  double tolerance = 1e-6;  ///< stop when a round lowers the energy by less than this share
  /// Rounds after which weights are stiffened (Bommes et al. 2009); 0 = plain symmetric Dirichlet.
  int stiffening_rounds = 6;
  double stiffening_factor = 1;  ///< c of Bommes et al. 2009
  double stiffening_limit = 5;   ///< d of Bommes et al. 2009, per round
};

/// A flat image of a disc, with the figures that tell how well it did.
struct PatchParametrization {
  MatrixX2d uv;  ///< #V x 2
  /// Symmetric Dirichlet energy by area, surface and image scaled to equal area: 4 is an isometry.
  double energy_before = 0;
  double energy_after = 0;
  /// Largest max(s1, 1 / s2) over the triangles, s1 >= s2 the singular values in that scale.
  double worst_stretch_before = 0;
  double worst_stretch_after = 0;
  double largest_stiffness = 1;  ///< of the weights of the last round
  int rounds = 0;
  bool converged = false;
};

/// Lowers the symmetric Dirichlet distortion of `start` (#V x 2, all triangles positive) and keeps
/// every triangle positive.
///
/// Each round Ceres solves the problem linearised at the present image, with triangles weighted by
/// local stiffening; a line search that starts short of the first inversion takes the step as far
/// as the weighted energy falls and exact predicates see no fold. Ceres' own trust region is not
/// used: one triangle near folding shrinks it for all.
///
/// kBadInput: `start` has the wrong size or a triangle that is not positive. kNumerical: Ceres
/// finds no step in the first round.
/// Source: Bommes, Zimmer, Kobbelt 2009, "Mixed-Integer Quadrangulation", Sec. 5.4 (stiffening).
/// Differs: stiffening works as a weight inside a loop free of folds, hence needs no repair.
Result<PatchParametrization> parametrize(const TriangleMesh& disc,
                                         const MatrixX2d& start,
                                         const ParametrizeOptions& options = {});

}  // namespace crosspatch
