#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// A triangulated surface known by its edge lengths alone. Half-edges are numbered as in
/// TriangleMesh (3 f + k); after flips it may hold edges from a vertex to itself and several edges
/// between two vertices.
///
/// Invariants: (1) twin is an involution, -1 on the boundary; (2) the two sides of an edge have one
/// length; (3) the lengths of every face obey the triangle inequality.
struct IntrinsicMesh {
  int vertex_count = 0;
  std::vector<int> from;       ///< per half-edge: the vertex it leaves
  std::vector<int> twin;       ///< per half-edge
  std::vector<double> length;  ///< per half-edge

  [[nodiscard]] int halfedge_count() const { return static_cast<int>(from.size()); }
  [[nodiscard]] int face_count() const { return halfedge_count() / 3; }
};

/// The edge lengths of `mesh`. (3) may hold with equality only: see mollify.
IntrinsicMesh intrinsic_mesh(const TriangleMesh& mesh);

/// Adds the smallest one length to all edges that makes every triangle inequality hold with a slack
/// of `relative_slack` mean edge lengths; returns the length added. Source: Sharp & Crane 2020, "A
/// Laplacian for Nonmanifold Triangle Meshes", Sec. 4.5.
double mollify(IntrinsicMesh& mesh, double relative_slack);

/// Flips edges until each is Delaunay (opposite angles add to at most pi); returns the number of
/// flips. Source: Bobenko & Springborn 2007. Cost: linear in practice.
int make_delaunay(IntrinsicMesh& mesh);

/// Area of face f by Kahan's stable form of Heron's formula.
double face_area(const IntrinsicMesh& mesh, int f);

/// Cotangent of the angle opposite to half-edge h.
double cotangent(const IntrinsicMesh& mesh, int h);

}  // namespace crosspatch
