#pragma once

#include <string>

#include "param/drawn_layout.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

/// The layout drawn on the other surface: every arc of `drawn` pushed through `map`, a bijection
/// from drawn.mesh to `target`. The target is refined where arcs run: they cross its edges exactly
/// where their images do, and are drawn straight in between. The layout and the numbering of nodes,
/// arcs and patches are the same, so cells correspond, and no two arcs can cross. kBadInput if the
/// map leaves a vertex out.
/// Source: Feng et al. 2013, Sec. 6 (copying the structure of the complex).
Result<DrawnLayout> copy_layout(const DrawnLayout& drawn,
                                const SurfaceMap& map,
                                const TriangleMesh& target);

/// The layout as text for drawing: OBJ with one vertex per path point, an `l` element per arc and a
/// comment line per node ("# node INDEX KIND VERTEX free|kept").
std::string layout_to_obj(const DrawnLayout& drawn);

}  // namespace crosspatch
