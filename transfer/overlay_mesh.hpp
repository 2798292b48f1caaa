#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "param/surface_map.hpp"
#include "transfer/source_attributes.hpp"

namespace crosspatch {

/// Marks of a triangle's side, or-ed.
enum SideMark : std::uint8_t {
  kTargetEdge = 1,  ///< part of an edge of the target mesh
  kSeam = 2,   ///< attributes or materials differ on its two sides, or nothing is carried there
  kExact = 4,  ///< the carried attributes are linear along it
};

/// A conforming triangle mesh on the target surface whose corners carry source attributes.
///
/// A wedge is a point together with one of the attribute vectors that meet there: triangles on one
/// side of a seam share wedges, triangles on two sides do not.
///
/// Invariants: (1) a triangle lies in the closed face `target_face` of the target; (2) its side k
/// runs from corner k to corner (k + 1) % 3, and the sides of neighbours match, marks included;
/// (3) points on an edge of the target have an exactly zero weight for the corner opposite to it;
/// (4) attributes has `width` entries a wedge.
struct OverlayMesh {
  struct Triangle {
    std::array<int, 3> wedge{};
    std::array<std::uint8_t, 3> side{};
    int target_face = -1;
    int material = -1;
    bool mapped = true;  ///< false in target faces that no usable source point is mapped to
    bool alive = true;
  };
  std::vector<SurfacePoint> points;  ///< on the target
  int map_points = 0;                ///< the first of them are those of the map, in its order
  std::vector<bool> target_vertex;   ///< per point: is a vertex of the target
  std::vector<int> wedge_point;
  std::vector<double> attributes;
  std::vector<Triangle> triangles;
  int degenerate_polygons = 0;  ///< overlay polygons too thin to be cut into sure triangles
  int unmapped_faces = 0;       ///< target faces without a complete image
  int seam_sides = 0;           ///< overlay sides, counted once, along seams of the source
};

/// The whole overlay as triangles. Target faces that the map's polygons do not fill become plain
/// triangles that are not mapped; so are polygons of source faces whose attributes are unusable.
OverlayMesh make_overlay_mesh(const SourceAttributes& attributes,
                              const TriangleMesh& source,
                              const TriangleMesh& target,
                              const SurfaceMap& map);

/// Whether the polygons of each target face fill it. Partly filled faces count as empty: a face
/// would otherwise have a hole, and half a face cannot be told from a mistake.
std::vector<bool> filled_faces(const TriangleMesh& target, const SurfaceMap& map);

/// Bounds for thinning, both on the difference to the exactly carried attributes.
struct ThinningOptions {
  double uv_tolerance_texels = 0.5;
  double color_tolerance = 0.5 / 255;
};

/// Removes points of the overlay that are neither vertices of the target nor needed by a seam or a
/// tolerance, in index order until none is left that can go. Points on edges of the target go on
/// both sides at once, so that the mesh stays conforming; the surface stays where it is. Errors are
/// measured against the overlay itself, at its removed points and where its removed sides meet the
/// new ones: between these places attributes and errors are linear. Returns the largest error that
/// was accepted.
AttributeError thin_out(OverlayMesh& mesh,
                        const SourceAttributes& attributes,
                        const TriangleMesh& target,
                        const ThinningOptions& options);

}  // namespace crosspatch
