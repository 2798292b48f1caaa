#pragma once

#include <string>

#include "core/soup.hpp"

namespace crosspatch {

/// Gives a soup a texture other than its own: the image at a path (PNG or JPEG, kept byte for
/// byte), or one that is painted to show the map: "checker" and "uv" (an image each, over the
/// texture coordinates), "position" (vertex colours by place in the bounding box; needs no texture
/// coordinates). Factors become white, all other textures of the materials are dropped.
///
/// kBadInput: the soup has no texture coordinates for an image, or the file is no PNG or JPEG.
Status give_texture(const std::string& what, PolygonSoup& soup);

}  // namespace crosspatch
