#pragma once

#include <vector>

#include "core/types.hpp"

namespace crosspatch {

/// Triangles glued along edges so that every edge joins at most two and every vertex has one fan.
///
/// Half-edge 3 t + k runs from T(t, k) to T(t, (k + 1) % 3), as in TriangleMesh. Invariants: (1)
/// mate[mate[h]] == h over the same two vertices of T, or mate[h] == -1; (2) dropped triangles have
/// no mates; (3) with the triangles marked in `turned` read backwards, mates run in opposite
/// directions; (4) corners share a `vertex` exactly where mates join them.
struct ManifoldCut {
  std::vector<int> mate;      ///< 3 #T
  std::vector<bool> turned;   ///< #T
  std::vector<bool> dropped;  ///< #T
  std::vector<int> vertex;    ///< 3 #T, per corner the smallest corner of its fan

  int crowded_edges = 0;    ///< edges where more than two triangles met
  int one_sided_edges = 0;  ///< edges cut because turning could not make their sides agree
};

/// Cuts the triangles `T` (#T x 3, no repeated vertex in a triangle) over `V` (#V x 3) into an
/// oriented manifold. At an edge with more than two triangles those that run in opposite
/// directions stay together, two and two: the sides of one solid, or else the flattest. In each
/// component the smaller area is turned. Triangles that would still share an edge without being
/// glued are dropped. O(#T log #T).
ManifoldCut cut_to_manifold(const MatrixX3d& V, const MatrixX3i& T);

/// Component index of each triangle over mates, numbered by first triangle; -1 where dropped.
std::vector<int> glued_components(const ManifoldCut& cut);

}  // namespace crosspatch
