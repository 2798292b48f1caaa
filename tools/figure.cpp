#include "tools/figure.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "tools/font.hpp"
#include "tools/palette.hpp"

namespace crosspatch {
namespace {

using std::size_t;

Bitmap draw_panel(
    const Scene& scene, const Panel& panel, int width, int height, int samples, int text_scale) {
  const int label_height = panel.label.empty() ? 0 : text_scale * (kFontHeight + 2);
  const int drawn_height = std::max(1, height - label_height);
  const int margin = std::min(width, drawn_height) / 40;
  const Camera camera = fit_camera(scene, panel.axes, width, drawn_height, margin);
  const Bitmap drawn =
      draw(scene, camera, {.width = width, .height = drawn_height, .samples = samples});
  Bitmap result = make_bitmap(width, height, Color::Ones());
  paste(result, drawn, 0, height - drawn_height);
  draw_text(result, 2 * text_scale, text_scale, panel.label, text_scale, Color::Constant(0.03F));
  return result;
}

}  // namespace

void paste(Bitmap& whole, const Bitmap& part, int x, int y) {
  assert(x >= 0 && y >= 0 && x + part.width <= whole.width && y + part.height <= whole.height);
  for (int row = 0; row < part.height; ++row) {
    const auto from = part.rgba.begin() + std::ptrdiff_t{4} * row * part.width;
    std::copy(from,
              from + std::ptrdiff_t{4} * part.width,
              whole.rgba.begin() + std::ptrdiff_t{4} * ((y + row) * whole.width + x));
  }
}

Bitmap draw_figure(const std::vector<Scene>& scenes,
                   const std::vector<Panel>& panels,
                   const FigureOptions& options) {
  const int count = static_cast<int>(panels.size());
  const int columns = std::min(options.columns, count), rows = (count + columns - 1) / columns;
  // Cell borders by rounding down, so that cells fill the figure whatever its size.
  const auto left = [&](int column) { return options.width * column / columns; };
  const auto top = [&](int row) { return options.height * row / rows; };
  const int text_scale = std::max(1, options.height / 450);
  std::vector<Bitmap> drawn(panels.size());
  tbb::parallel_for(0, count, [&](int i) {
    const Panel& panel = panels[static_cast<size_t>(i)];
    const int column = i % columns, row = i / columns;
    drawn[static_cast<size_t>(i)] = draw_panel(scenes[static_cast<size_t>(panel.scene)],
                                               panel,
                                               left(column + 1) - left(column),
                                               top(row + 1) - top(row),
                                               options.samples,
                                               text_scale);
  });
  Bitmap figure = make_bitmap(options.width, options.height, Color::Ones());
  for (int i = 0; i < count; ++i)
    paste(figure, drawn[static_cast<size_t>(i)], left(i % columns), top(i / columns));
  return figure;
}

Bitmap draw_matrix(const Eigen::MatrixXd& matrix, int width, int height) {
  const int rows = static_cast<int>(matrix.rows()), columns = static_cast<int>(matrix.cols());
  if (rows == 0 || columns == 0) return make_bitmap(width, height, Color::Ones());
  const int cell = std::max(1, std::min(width / columns, height / rows));
  const double low = matrix.minCoeff(), range = matrix.maxCoeff() - low;
  Bitmap bitmap = make_bitmap(cell * columns, cell * rows, Color::Ones());
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const Color color = field_color(range > 0 ? (matrix(i, j) - low) / range : 0);
      for (int y = 0; y < cell; ++y)
        for (int x = 0; x < cell; ++x) set_pixel(bitmap, j * cell + x, i * cell + y, color);
    }
  return bitmap;
}

}  // namespace crosspatch
