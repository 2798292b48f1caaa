#pragma once

#include <array>
#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

enum class TutteWeights {
  kSymmetric,  ///< w_ij + w_ji of the mean-value weights: one Cholesky factor, the fastest
  kMeanValue,  ///< Floater 2003: reproduces flat discs, needs an LU factor
  kUniform,    ///< every neighbour counts alike
};

struct TutteOptions {
  TutteWeights weights = TutteWeights::kSymmetric;
  /// Rounds that change the weights so as to even out the areas of the image; up to 8 are made
  /// where the image of a long limb, which shrinks exponentially, falls below rounding.
  int evening_rounds = 0;
};

/// Maps a disc onto a convex polygon such that every inner vertex is a weighted mean of its
/// neighbours (Tutte 1963; Floater 2003). Weights are positive, hence every triangle keeps its
/// orientation, which is verified exactly; where rounding spoils it, weights are evened
/// out, then uniform ones are tried.
///
/// `boundary_loop`: the vertices of the only boundary, surface on the left (as boundary_loops
/// gives it, any start); `boundary_positions` (#loop x 2): their places, counter-clockwise on a
/// convex polygon. Points inside a straight side are allowed; no inner edge and no triangle may
/// join points of one straight side only (see split_chords).
/// Returns #V x 2, row i is vertex i. kBadInput: not a disc, the loop is not its boundary, the
/// polygon is not convex. kNumerical: factorization failed, or triangles are not positive; the
/// message names their number and the worst.
Result<MatrixX2d> tutte_embedding(const TriangleMesh& disc,
                                  const std::vector<int>& boundary_loop,
                                  const MatrixX2d& boundary_positions,
                                  const TutteOptions& options = {});

/// Faces of `mesh` whose image in the plane is not counter-clockwise, by exact arithmetic.
std::vector<int> folded_faces(const TriangleMesh& mesh, const MatrixX2d& uv);

/// A mesh with some edges split, and where its parts come from.
struct SplitMesh {
  TriangleMesh mesh;                            ///< vertices of the parent come first, unchanged
  std::vector<std::array<int, 2>> parent_edge;  ///< per new vertex: the edge it is the middle of
  std::vector<int> parent_face;                 ///< per face
};

/// Splits every inner edge that joins two boundary vertices at its midpoint. Afterwards no inner
/// edge joins boundary vertices; faces keep their order, parts of one face follow each other.
SplitMesh split_chords(const TriangleMesh& mesh);

}  // namespace crosspatch
