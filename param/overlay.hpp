#pragma once

#include "param/surface_map.hpp"

namespace crosspatch {

/// The common subdivision of two closed meshes of genus 0 that are embedded in the unit sphere with
/// great-circle edges: the map that sends each point of `source` to the point of `target` at the
/// same place of the sphere.
///
/// `X` (#V source x 3) and `Y` (#V target x 3): every face positively oriented. A vertex of one
/// mesh may coincide with a vertex of the other (bit-equal rows: a landmark), and edges between
/// such vertices may coincide; otherwise no vertex may lie on an edge. All decisions are made by
/// exact predicates on the given doubles, so that the subdivision's combinatorics are those of the
/// real numbers. The error names a vertex in special position as "source vertex 12" or "target
/// vertex 12"; vertex and side are also returned in `special`, if given.
struct SpecialPosition {
  bool on_source = false;
  int vertex = -1;
};
Result<SurfaceMap> overlay_on_sphere(const TriangleMesh& source,
                                     const MatrixX3d& X,
                                     const TriangleMesh& target,
                                     const MatrixX3d& Y,
                                     SpecialPosition* special = nullptr);

}  // namespace crosspatch
