#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/file_bytes.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// kBadInput when the soup has grown beyond `limits`; `coordinates` are three a vertex.
Status check_size(const PolygonSoup& soup,
                  const std::vector<double>& coordinates,
                  const ReadLimits& limits);

/// Ends the polygon whose corners were appended to soup.corner_vertex.
inline void end_polygon(PolygonSoup& soup) {
  soup.polygon_begin.push_back(soup.corner_count());
}

/// Coordinates, three a vertex, as the soup's matrix.
MatrixX3d as_positions(const std::vector<double>& coordinates);

/// A colour channel in [0, 1] from the sRGB curve to linear light (IEC 61966-2-1).
float linear_from_srgb(double value);

// One parser a format, from the bytes of a file to a soup; see read_soup for what they promise.
// `folder` is where the names of other files inside the file are looked for.

Result<PolygonSoup> parse_obj(std::string_view text,
                              const std::filesystem::path& folder,
                              const ReadLimits& limits);
Result<PolygonSoup> parse_ply(std::string_view bytes,
                              const std::filesystem::path& folder,
                              const ReadLimits& limits);
Result<PolygonSoup> parse_off(std::string_view text, const ReadLimits& limits);
Result<PolygonSoup> parse_stl(std::string_view bytes, const ReadLimits& limits);

/// Fills in the materials of `soup` whose names `text`, an MTL file, defines; their images are
/// added to the soup. kBadInput: a value that is no finite number, an unusable image header.
Status parse_mtl(std::string_view text,
                 const std::filesystem::path& folder,
                 const ReadLimits& limits,
                 PolygonSoup& soup);

/// Index of the image that `name` means in `folder`, added to `soup` if it is new; -1 with a note
/// where it cannot be found. kBadInput: too large, unusable header.
Result<int> add_image(std::string_view name,
                      const std::filesystem::path& folder,
                      const ReadLimits& limits,
                      PolygonSoup& soup);

}  // namespace crosspatch
