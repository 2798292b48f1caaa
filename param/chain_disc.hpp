#pragma once

#include <array>
#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// A closed surface of genus 0 cut open along a chain of paths and laid out in the unit disc.
///
/// The chain visits k landmarks; its k - 1 paths are disjoint but for the landmarks they share. The
/// boundary of the disc runs along the chain from the first landmark to the last with the surface
/// on its left, and back on the other bank: 2 (k - 1) sides of equal angle, each divided by arc
/// length. A pair of surfaces cut along corresponding chains thus meets in one domain, whatever the
/// order of arcs around the landmarks (each has at most two).
struct ChainDisc {
  TriangleMesh mesh;  ///< cut open, in space; edges crossed by paths are split
  MatrixX3d
      domain;  ///< #V x 3, rows (x, y, 1) with (x, y) in the unit disc, faces positively oriented
  std::vector<int>
      vertex;  ///< per vertex: the surface's vertex, or #V + i for the middle of split_edges[i]
  std::vector<std::array<int, 2>> split_edges;  ///< pairs of such numbers, earlier ones first
  std::vector<int> disc_vertex;                 ///< per vertex of the surface: one of its copies
  double chain_length = 0;
};

/// Cuts `mesh` along shortest paths (over vertices and edge midpoints) through `landmarks` in their
/// order, at least two, all different. Later paths avoid earlier ones and all landmarks. kNumerical
/// where a path is blocked or the disc cannot be laid out; Source: Tutte 1963 for the layout, Born
/// et al. 2021 for tracing over edge midpoints.
Result<ChainDisc> cut_along_chain(const TriangleMesh& mesh, const std::vector<int>& landmarks);

/// Values given at the surface's vertices (#V x d) carried to the disc's vertices: split edges take
/// the mean of their ends.
MatrixX3d to_disc(const ChainDisc& disc, const MatrixX3d& values);

/// The image of the vertices of `a` on surface b, when both discs are laid over each other:
/// #V(a.mesh) x 3, positions interpolated from `values_b` (one row a vertex of b.mesh).
MatrixX3d through_disc(const ChainDisc& a, const ChainDisc& b, const MatrixX3d& values_b);

/// Area-weighted mean of log(|J|^2 + |J^-1|^2) of the map between two discs, the mean of both
/// directions (isometry of surfaces of equal area: log 4); valid for wrong assignments too.
double disc_distortion(const ChainDisc& a, const ChainDisc& b);

}  // namespace crosspatch
