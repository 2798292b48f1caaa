#pragma once

#include <vector>

#include "core/progressive_mesh.hpp"

namespace crosspatch {

/// A closed surface of genus 0 made ready to be mapped: what is computed once per surface, whatever
/// it is mapped to.
struct Shape {
  TriangleMesh mesh;            ///< area 1
  ProgressiveMesh progressive;  ///< its levels
  MeshLevel coarse;  ///< the level on which candidate maps are judged; holds every landmark
  MatrixX3d X;       ///< #V x 3, its embedding in the unit sphere
  Eigen::MatrixXd curvature;     ///< #V x fields, see curvature_fields
  Eigen::MatrixXd chirality;     ///< #V x fields, see chirality_fields; empty where nobody asked
  std::vector<int> extremities;  ///< see ShapeFeatures; empty where nobody asked
  Eigen::MatrixXd extremity_distances;  ///< #V x extremities
};

struct ShapeOptions {
  int coarse_vertices =
      1600;  ///< ours: the judge is as right at 1600 as at 5000 vertices, and ten times as fast
};

/// `mesh` must be closed, connected, of genus 0 and of area 1; `landmarks` are vertices that the
/// coarse level must keep. kNoCorrespondence for another topology; kNumerical from the stages.
Result<Shape> make_shape(TriangleMesh mesh,
                         const std::vector<int>& landmarks,
                         const ShapeOptions& options = {});

/// The same surface with another coarse level, one that holds these landmarks. Errors of
/// make_shape.
Result<Shape> with_coarse_level(const Shape& shape,
                                const std::vector<int>& landmarks,
                                const ShapeOptions& options = {});

}  // namespace crosspatch
