#pragma once

#include <string>
#include <vector>

#include "tools/view.hpp"

namespace crosspatch {

/// One picture of a figure.
struct Panel {
  int scene = 0;                                       ///< into the figure's scenes
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< of the camera
  std::string label;
};

struct FigureOptions {
  int width = 1200;  ///< pixels, of the whole figure
  int height = 900;
  int columns = 2;  ///< panels in a row
  int samples = 3;  ///< per pixel and direction
};

/// Draws the panels row by row, each fitted into its place with its label above it. Panels are
/// drawn in parallel; the result does not depend on that. Preconditions: at least one panel, all
/// sizes positive.
Bitmap draw_figure(const std::vector<Scene>& scenes,
                   const std::vector<Panel>& panels,
                   const FigureOptions& options);

/// A matrix as an image: row 0 at the top, one cell of whole pixels an entry (at least one), field
/// colours from the least to the greatest entry.
Bitmap draw_matrix(const Eigen::MatrixXd& matrix, int width, int height);

/// Copies `part` into `whole` with its upper left corner at (x, y). Precondition: it fits.
void paste(Bitmap& whole, const Bitmap& part, int x, int y);

}  // namespace crosspatch
