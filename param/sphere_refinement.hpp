#pragma once

#include <vector>

#include "core/progressive_mesh.hpp"
#include "param/sphere_optimizer.hpp"

namespace crosspatch {

struct RefineOptions {
  int until_vertices = 0;        ///< stop at this many vertices (the full mesh if it has fewer)
  std::vector<int> pinned = {};  ///< vertices of the full mesh that never move
  double growth = 3;  ///< the whole level is optimised each time its vertex count has grown so much
  SphereOptimizerOptions optimizer = {};
};

/// Splits vertices back into a level embedded in the sphere: each goes into the kernel of its ring,
/// where its faces have the least energy after the lift, so that no face is ever turned over (Praun
/// & Hoppe 2003, with the symmetric Dirichlet energy). `V` (#V x 3) are the surface's positions,
/// `X` (#V x 3) the embedding, `hint` (#V) faces of the lift; rows of vertices not yet split are
/// filled in. kNumerical where a kernel is empty in double precision.
Status refine_on_sphere(Refinement& refinement,
                        const MatrixX3d& V,
                        const Lift& lift,
                        const RefineOptions& options,
                        MatrixX3d& X,
                        std::vector<int>& hint);

/// Moves the vertices of badly distorted faces, one at a time, to the best place inside the kernels
/// of their rings: gets states going in which a few squeezed faces stop every common step.
/// Arguments as in refine_on_sphere.
void relax_worst(const Refinement& level,
                 const MatrixX3d& V,
                 const Lift& lift,
                 const std::vector<int>& pinned,
                 MatrixX3d& X,
                 std::vector<int>& hint);

/// An embedding of a closed mesh of genus 0 and area 1 in the unit sphere (#V x 3, unit rows),
/// every face positively oriented, with low symmetric Dirichlet energy to the sphere of area 1.
/// kNumerical where a level cannot be embedded.
Result<MatrixX3d> embed_in_sphere(const TriangleMesh& mesh, const ProgressiveMesh& progressive);

}  // namespace crosspatch
