#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

enum class EdgeRole : std::uint8_t {
  kDescending,  ///< paired with the end from which the function descends along it
  kAscending,   ///< paired with the face into which the function ascends across it
  kSaddle,      ///< critical
};

/// A discrete Morse gradient of a function on a closed surface, kept as the role of each edge.
///
/// Edges of role kDescending are a spanning forest of the vertices with one minimum in each tree;
/// those of role kAscending are a spanning forest of the dual graph with one maximum (a face) in
/// each tree; the rest are saddles. Cancelling a saddle with an extremum thus only moves the saddle
/// edge into a forest.
///
/// A mesh with boundary is closed: each boundary loop gets a cone whose apex has the value of the
/// loop's lowest vertex and stands for it. Vertices from mesh_vertex_count on are apexes.
///
/// Invariants: (1) surface is closed; (2) both sides of an edge have one role; (3) the two forests
/// are as above, with the roots `minima` and `maxima`; (4) #minima - #saddles + #maxima is the
/// Euler characteristic of surface.
struct DiscreteGradient {
  TriangleMesh surface;             ///< the mesh, closed
  int mesh_vertex_count = 0;        ///< vertices of the mesh itself
  std::vector<int> representative;  ///< per vertex of surface: a vertex of the mesh
  Eigen::VectorXd values;           ///< per vertex of surface
  std::vector<int> rank;  ///< per vertex: its place in the order by (value, index), all different
  std::vector<EdgeRole> role;  ///< per half-edge
  std::vector<int> minima;     ///< vertices
  std::vector<int> saddles;    ///< half-edges, the lower one of the edge's two
  std::vector<int> maxima;     ///< faces
};

/// Computes the gradient of `values` (#V) by processing lower stars; equal values are told apart by
/// vertex index (simulation of simplicity). kBadInput if a value is not finite or the size is
/// wrong. Source: Robins, Wood & Sheppard 2011, "Theory and Algorithms for Constructing Discrete
/// Morse Complexes".
Result<DiscreteGradient> discrete_gradient(const TriangleMesh& mesh, const Eigen::VectorXd& values);

/// Checks every invariant of DiscreteGradient.
Status validate(const DiscreteGradient& gradient);

/// The end of highest rank of half-edge h's edge, and the highest corner of face f.
int highest_end(const DiscreteGradient& gradient, int h);
int highest_corner(const DiscreteGradient& gradient, int f);

/// The forests as pointers towards their roots.
struct GradientForests {
  std::vector<int> down;     ///< per vertex: half-edge to its parent, -1 at minima
  std::vector<int> up;       ///< per face: its half-edge towards the parent face, -1 at maxima
  std::vector<int> minimum;  ///< per vertex: root
  std::vector<int> maximum;  ///< per face: root
};
GradientForests forests(const DiscreteGradient& gradient);

}  // namespace crosspatch
