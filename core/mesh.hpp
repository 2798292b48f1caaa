#pragma once

#include <vector>

#include "core/result.hpp"
#include "core/types.hpp"

namespace crosspatch {

/// An oriented manifold triangle mesh, with or without boundary.
///
/// Half-edge h = 3 f + k runs from F(f, k) to F(f, (k + 1) % 3) with face f on its left, so that
/// half-edges, face corners and the corners of barycentric coordinates share one numbering.
///
/// Invariants: (1) every face has three different vertices in [0, #V); (2) twin[twin[h]] == h and
/// the two run in opposite directions, or twin[h] == -1 on the boundary; (3) the faces around each
/// vertex form one fan or one cycle; (4) out[v] is a half-edge that leaves v, on the boundary the
/// one without a face on its right; (5) no isolated vertices.
struct TriangleMesh {
  MatrixX3d V;            ///< #V x 3, row i is vertex i
  MatrixX3i F;            ///< #F x 3, counter-clockwise seen from outside
  std::vector<int> twin;  ///< 3 #F
  std::vector<int> out;   ///< #V

  [[nodiscard]] int vertex_count() const { return static_cast<int>(V.rows()); }
  [[nodiscard]] int face_count() const { return static_cast<int>(F.rows()); }
  [[nodiscard]] int halfedge_count() const { return 3 * face_count(); }
  [[nodiscard]] int from(int h) const { return F(h / 3, h % 3); }
  [[nodiscard]] int to(int h) const { return F(h / 3, (h + 1) % 3); }
  /// The vertex opposite to h in its face.
  [[nodiscard]] int tip(int h) const { return F(h / 3, (h + 2) % 3); }
  [[nodiscard]] Vector3d position(int v) const { return V.row(v).transpose(); }
};

inline int next(int h) {
  return h - h % 3 + (h + 1) % 3;
}
inline int prev(int h) {
  return h - h % 3 + (h + 2) % 3;
}
inline int face_of(int h) {
  return h / 3;
}

/// Builds the connectivity of `F` (#F x 3) over the points `V` (#V x 3). kBadInput where an
/// invariant of TriangleMesh cannot hold: index out of range, repeated corner, edge with more than
/// two faces or with faces of opposite orientation, vertex whose faces are not one fan, isolated
/// vertex.
Result<TriangleMesh> make_mesh(MatrixX3d V, MatrixX3i F);

/// Checks every invariant of TriangleMesh.
Status validate(const TriangleMesh& mesh);

/// Calls visit(h) for every half-edge h that leaves v, counter-clockwise; on the boundary it starts
/// at out[v].
template <class Visit>
void for_each_outgoing(const TriangleMesh& mesh, int v, Visit visit) {
  const int start = mesh.out[static_cast<std::size_t>(v)];
  int h = start;
  do {
    visit(h);
    h = mesh.twin[static_cast<std::size_t>(prev(h))];
  } while (h >= 0 && h != start);
}

/// The half-edge from u to v, or -1.
int find_halfedge(const TriangleMesh& mesh, int u, int v);

/// Corresponds to #V - #E + #F.
int euler_characteristic(const TriangleMesh& mesh);

/// Vertices of each boundary loop, in the order of the boundary half-edges (surface on the left).
std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh);

/// Genus of a connected mesh: (2 - chi - loops) / 2.
int genus(const TriangleMesh& mesh);

/// Component index of each face, numbered by first face.
std::vector<int> face_components(const TriangleMesh& mesh);

Eigen::VectorXd face_areas(const TriangleMesh& mesh);
double total_area(const TriangleMesh& mesh);

/// Area-weighted unit normals, #V x 3; zero where the incident faces have no area.
MatrixX3d vertex_normals(const TriangleMesh& mesh);

/// The mesh moved to its area-weighted centroid and scaled to total area 1. Precondition: positive
/// total area.
TriangleMesh normalized(TriangleMesh mesh);

}  // namespace crosspatch
