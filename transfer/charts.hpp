#pragma once

#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

struct ChartOptions {
  /// How far a chart may bend: one minus the length of its mean normal, 0 flat, 1/2 a hemisphere.
  /// Ours: a tube falls into three strips.
  double bend = 0.3;
  /// Cosine of the largest angle between a face and its chart's mean normal; above it the chart's
  /// shadow along that normal has no turned faces.
  double least_cosine = 0.2;
  /// Weight of the roundness of the outline, perimeter^2 / (4 pi area), against the bend.
  double roundness = 0.05;
};

/// Parts of a mesh that are flat enough to be laid out: chart of each face, 0 .. count - 1, every
/// chart connected across edges.
struct Charts {
  std::vector<int> of_face;
  int count = 0;
};

/// Grows charts from single faces by joining the two neighbours whose union is the flattest and
/// roundest, as long as there are two that may be joined.
/// Source: Garland, Willmott, Heckbert 2001, "Hierarchical face clustering on polygonal surfaces".
/// Differs: flatness by normals alone, as in Cohen-Steiner, Alliez, Desbrun 2004 (L2,1).
Charts make_charts(const TriangleMesh& mesh, const ChartOptions& options = {});

/// The faces of one chart laid flat at their own scale, corner by corner in the order of `faces`:
/// their shadow along the mean normal, improved by lowering the symmetric Dirichlet energy. Turned
/// faces: none. The image may overlap itself where the chart coils.
std::vector<Vector2d> flatten_chart(const TriangleMesh& mesh, const std::vector<int>& faces);

/// The plain shadow along the mean normal, scaled to the chart's area.
std::vector<Vector2d> chart_shadow(const TriangleMesh& mesh, const std::vector<int>& faces);

}  // namespace crosspatch
