#pragma once

#include <filesystem>

#include "core/file_bytes.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// Reads an OBJ (with its MTL and images), PLY, OFF or STL file, chosen by extension.
///
/// Vertices and polygons are numbered as in the file: the i-th `v` line, the i-th vertex element;
/// an STL facet brings three vertices of its own. Polygons of fewer than three corners and
/// polygons that repeat a vertex are kept as they are. OBJ and PLY texture coordinates are turned
/// to v downwards; 8-bit and OBJ vertex colours are taken as sRGB and made linear. MTL files and
/// images are looked for in the file's own folder and below it only; one that is missing or
/// elsewhere is passed over with a note.
///
/// kBadInput, with the line or element: unknown extension, a limit exceeded, counts the file has
/// no bytes for, a word where a number belongs, a number that is not finite, an index out of
/// range, an unusable image header, no polygon at all.
///
/// Differs: OpenMesh's readers are not used. Through its importer interface they give
/// single-precision coordinates only, drop OBJ vertices that are not finite (and so shift the
/// numbers of the rest) and polygons with a repeated vertex, weld STL corners, and never return
/// from a PLY header that is cut short.
Result<PolygonSoup> read_soup(const std::filesystem::path& path, const ReadLimits& limits = {});

}  // namespace crosspatch
