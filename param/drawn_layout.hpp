#pragma once

#include <vector>

#include "core/surface_point.hpp"
#include "param/layout.hpp"

namespace crosspatch {

/// A layout drawn on a surface, the surface refined such that arcs are paths of edges.
///
/// Invariants: (1) path[a] leads from the vertex of a's saddle to that of its extremum, each vertex
/// next to the one before; (2) no two arcs share a vertex other than their nodes', and no arc
/// visits one twice; (3) patch[f] is the layout's face that mesh face f lies in: constant across
/// every edge that is on no arc, and the face of dart 2 a left of arc a, of 2 a + 1 right of it;
/// (4) every patch is a disc once cut open along its arcs.
struct DrawnLayout {
  QuadLayout layout;
  TriangleMesh mesh;                   ///< the given one refined; its vertices come first
  std::vector<SurfacePoint> origin;    ///< per vertex: where it lies on the given mesh
  std::vector<int> parent_face;        ///< per face: the given mesh's face it is part of
  std::vector<int> node_vertex;        ///< per node of the layout
  std::vector<std::vector<int>> path;  ///< per arc
  std::vector<int> patch;              ///< per face
};

/// Draws `layout`, made of `gradient`, on its surface.
///
/// Ascending arcs run across the edges of the gradient's dual forest, descending ones along its
/// forest of edges, so the two kinds never meet but in saddles. Where several arcs share an edge
/// they are drawn side by side, in the order in which a walk around the tree meets their saddles:
/// all but one are led around the vertices, across the edges beside them. Saddles lie in the middle
/// of their edges, maxima inside their faces.
/// kBadInput if the surface was closed by cones over boundary loops.
Result<DrawnLayout> draw_layout(const QuadLayout& layout, const DiscreteGradient& gradient);

/// Checks every invariant of DrawnLayout.
Status validate(const DrawnLayout& drawn);

/// Per half-edge of `mesh`: the dart that runs along it, or -1, given the arcs as paths of edges.
/// kInternal where a path leaves the edges or two share one.
Result<std::vector<int>> darts_on_halfedges(const TriangleMesh& mesh,
                                            const std::vector<std::vector<int>>& path);

/// Labels the faces of `mesh` by the faces of `layout`, given the arcs as paths of edges (see
/// DrawnLayout). kInternal where the labels contradict each other or a face is not reached.
Result<std::vector<int>> label_patches(const TriangleMesh& mesh,
                                       const QuadLayout& layout,
                                       const std::vector<std::vector<int>>& path);

}  // namespace crosspatch
