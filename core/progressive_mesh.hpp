#pragma once

#include <array>
#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// A mesh as a sequence of half-edge collapses (Hoppe 1996): every level is a closed manifold mesh
/// on a subset of the vertices.
///
/// Invariants: (1) collapse i removes vertex removed[i] into its neighbour kept[i]; (2) it deletes
/// the faces lost[i] and turns the corner removed[i] of the faces turned[begin[i] .. begin[i + 1])
/// into kept[i]; (3) `coarsest` holds the faces after all collapses; rows of deleted faces are
/// stale and alive[f] is false.
struct ProgressiveMesh {
  std::vector<int> removed, kept;
  std::vector<std::array<int, 2>> lost;
  std::vector<int> begin{0};
  std::vector<int> turned;
  MatrixX3i coarsest;       ///< #F x 3
  std::vector<bool> alive;  ///< #F
  int vertex_count = 0;     ///< of the full mesh

  [[nodiscard]] int collapse_count() const { return static_cast<int>(removed.size()); }
};

struct ProgressiveOptions {
  /// Down to this many vertices a collapse may not turn a face by more than a right angle, nor
  /// remove a protected vertex: these levels stand for the shape. Below, only the topology matters
  /// (they seed the spherical embedding).
  int shape_vertices = 1600;
  std::vector<int> protected_vertices = {};
};

/// Collapses a closed mesh of genus 0 to a tetrahedron, cheapest quadric error first (Garland &
/// Heckbert 1997, OpenMesh). kNumerical when the collapses stop before four vertices are left.
Result<ProgressiveMesh> make_progressive_mesh(const TriangleMesh& mesh,
                                              const ProgressiveOptions& options = {});

/// A walk through the levels, from the coarsest towards the full mesh. Further collapses may be put
/// on top; they are undone first.
class Refinement {
 public:
  explicit Refinement(ProgressiveMesh progressive);

  /// Undoes the last collapse in force; returns its vertex. Precondition: !done().
  int split();
  /// Collapses v into its neighbour `kept`. Precondition: can_collapse(v, kept).
  void collapse(int v, int kept);
  /// Whether the faces stay a closed manifold: v and `kept` have exactly two neighbours in common,
  /// and more than four vertices are left.
  [[nodiscard]] bool can_collapse(int v, int kept) const;

  [[nodiscard]] bool done() const { return next_ == 0; }
  [[nodiscard]] int vertex_count() const { return progressive_.vertex_count - next_; }
  /// Faces around v at this level, in no particular order; empty if v is collapsed.
  [[nodiscard]] const std::vector<int>& faces(int v) const {
    return faces_[static_cast<std::size_t>(v)];
  }
  [[nodiscard]] const MatrixX3i& F() const { return F_; }
  [[nodiscard]] bool alive(int f) const { return alive_[static_cast<std::size_t>(f)]; }
  /// The kept end of the collapse undone last.
  [[nodiscard]] int last_kept() const { return progressive_.kept[static_cast<std::size_t>(next_)]; }
  /// Faces of this level, compact, over the full mesh's vertex numbers.
  [[nodiscard]] MatrixX3i compact_faces() const;
  /// The collapses in force, with this level as the coarsest. Precondition: nothing was split.
  [[nodiscard]] ProgressiveMesh progressive() &&;
  /// Neighbours of v, sorted.
  [[nodiscard]] std::vector<int> neighbours(int v) const;

 private:
  ProgressiveMesh progressive_;
  int next_;  ///< number of collapses still in force
  MatrixX3i F_;
  std::vector<bool> alive_;
  std::vector<std::vector<int>> faces_;
};

/// One level as a mesh of its own.
struct MeshLevel {
  TriangleMesh mesh;
  std::vector<int> vertex;  ///< per vertex of the level: its number in the full mesh
};

/// The level with `vertices` vertices (the coarsest one if fewer collapses were possible).
Result<MeshLevel> mesh_level(const TriangleMesh& mesh,
                             const ProgressiveMesh& progressive,
                             int vertices);
/// The level a walk has got to.
Result<MeshLevel> mesh_level(const TriangleMesh& mesh, const Refinement& refinement);

}  // namespace crosspatch
