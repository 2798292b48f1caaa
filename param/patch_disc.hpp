#pragma once

#include <vector>

#include "param/drawn_layout.hpp"

namespace crosspatch {

/// A patch of a drawn layout, cut open along its arcs: an ordinary disc even where both sides of an
/// arc belong to it.
struct PatchDisc {
  TriangleMesh mesh;
  std::vector<SurfacePoint> origin;  ///< per vertex: where it lies on the drawn mesh
  std::vector<int> vertex;           ///< per vertex: the drawn mesh's vertex there, or -1
  std::vector<int> parent_face;      ///< per face: the drawn mesh's face it is part of
  std::vector<int> loop;             ///< the boundary, counter-clockwise, from its first corner
  std::vector<int> side;             ///< per loop entry: which of the four sides starts or holds it
  std::vector<double> share;         ///< per loop entry: share of the arc's length, from its saddle
};

/// Shares of the length at which the vertices of an arc lie, 0 first and 1 last: multiples of
/// 2^-40, each larger than the one before, so that 1 - s is exact.
std::vector<double> arc_fractions(const TriangleMesh& mesh, const std::vector<int>& path);

/// Cuts patches out of one drawn layout.
class PatchCutter {
 public:
  /// `drawn` must outlive the cutter and satisfy its invariants.
  explicit PatchCutter(const DrawnLayout& drawn);

  /// The patch of the layout's face `face`; side k belongs to dart k of darts_of_face. `fractions`
  /// holds, per arc, rising shares of its length; where no vertex of the arc is, one is added. No
  /// inner edge joins boundary vertices (they are split). kInternal if the patch is no disc.
  [[nodiscard]] Result<PatchDisc> cut(int face,
                                      const std::vector<std::vector<double>>& fractions) const;

 private:
  [[nodiscard]] std::vector<int> corner_classes(int face, int& count) const;

  const DrawnLayout& drawn_;
  std::vector<int> dart_;                 ///< per half-edge
  std::vector<std::vector<int>> faces_;   ///< per patch
  std::vector<int> place_;                ///< per face: its place in its patch's list
  std::vector<std::vector<double>> own_;  ///< per arc: shares of its vertices
};

}  // namespace crosspatch
