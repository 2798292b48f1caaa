#pragma once

#include <string>
#include <vector>

#include "tools/benchmarks/sparse_shape.hpp"
#include "tools/figure.hpp"

namespace crosspatch {

/// Panels of a figure, in the order in which they are drawn.
struct PictureSheet {
  std::vector<Scene> scenes;
  std::vector<Panel> panels;
};

/// Adds both surfaces side by side in the colours of log ADF, with their critical points (maxima
/// red, saddles green, minima blue) and a line a match: grey, or thick and red where the match is
/// farther than 0.25 sqrt(area) from the truth.
void add_matching(PictureSheet& sheet,
                  const std::string& label,
                  const SparseShape& source,
                  const SparseShape& target,
                  const JudgedMatching& judged);

/// Draws the sheet into a PNG file. kOutput if it cannot be written.
Status write_sheet(const PictureSheet& sheet, int columns, const std::string& path);
/// The same for a picture.
Status write_picture(const Bitmap& picture, const std::string& path);

}  // namespace crosspatch
