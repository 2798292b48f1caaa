#pragma once

#include <array>
#include <vector>

#include "param/capped.hpp"
#include "param/piece.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// One side of a collar: the strip of a surface around an opening, cut open to a disc.
struct CollarSide {
  Piece disc;
  std::vector<int> loop;      ///< the boundary, surface on the left
  std::vector<int> loop_key;  ///< per entry: equal where and only where the strip was cut
};

/// A strip around an opening of two surfaces, mapped anew.
///
/// Invariants: both loops have one length, and entry i of one corresponds to entry i of the other:
/// equal keys, and equal Piece::point where the loop runs along the rest of the map.
struct Collar {
  CollarSide source, target;
  SurfaceMap map;  ///< between the discs
};

/// What of one surface takes part in a collar.
struct CollarPart {
  const TriangleMesh& surface;  ///< as given: neither cut nor filled
  const CappedSurface& capped;
  std::vector<const Cap*> openings;  ///< one hole, or both banks of a handle
};

/// The collar of an opening. `closed` is a map between the filled surfaces, `region` a set of its
/// polygons: a disc around each opening of the source that covers the partner's, or two. What is
/// left of it without the caps is an annulus on either surface; the banks of a handle are joined to
/// one, rims of holes go to each other by arc length. Both are cut open along a shortest path and
/// laid out in a circle with their rims together (Tutte). kInternal where the parts are no annuli,
/// kNumerical where they cannot be laid out.
Result<Collar> make_collar(const SurfaceMap& closed,
                           const std::vector<int>& region,
                           const CollarPart& source,
                           const CollarPart& target);

}  // namespace crosspatch
