#pragma once

#include <string>

#include "core/prepare.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// Gives a soup a texture other than its own: the image at a path (PNG or JPEG, kept byte for
/// byte), or one that is painted to show the map: "checker" and "uv" (an image each, over the
/// texture coordinates), "position" (vertex colours by place in the bounding box; needs no texture
/// coordinates), "distortion" (white vertex colours, for color_by_distortion once there is a map).
/// Factors become white, all other textures of the materials are dropped.
///
/// kBadInput: the soup has no texture coordinates for an image, or the file is no PNG or JPEG.
Status give_texture(const std::string& what, PolygonSoup& soup);

/// Vertex colours from white (isometric) to dark red; see heat_color. `energy`: the symmetric
/// Dirichlet energy around each vertex of the mesh made of the soup; white where that left a vertex
/// out.
void color_by_distortion(const FileNumbering& numbering,
                         const Eigen::VectorXd& energy,
                         PolygonSoup& soup);

}  // namespace crosspatch
