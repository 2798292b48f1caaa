#include "tools/benchmarks/picture.hpp"

#include "core/index.hpp"
#include "tools/image_io.hpp"
#include "tools/output_files.hpp"
#include "tools/palette.hpp"
#include "tools/scene_pair.hpp"
#include "tools/scene_surface.hpp"

namespace crosspatch {
namespace {

constexpr double kNodeRadius = 0.010, kLineRadius = 0.0012;  // of the diagonal
constexpr double kWrong = 0.25;                              // sqrt(area)

Scene scene_of(const SparseShape& shape) {
  Surface surface = make_surface(shape.mesh().V, shape.mesh().F);
  color_field(surface, shape.features.log_adf);
  Scene scene;
  scene.surfaces.push_back(std::move(surface));
  const double radius = kNodeRadius * diagonal(shape.mesh().V);
  for (const MorseNode& node : shape.matching.graph.complex.nodes) {
    const Color color = node.kind == NodeKind::kMaximum  ? Color(0.8F, 0.02F, 0.02F)
                        : node.kind == NodeKind::kSaddle ? Color(0.02F, 0.5F, 0.05F)
                                                         : Color(0.03F, 0.06F, 0.8F);
    add_points(scene, shape.mesh().V.row(node.vertex), radius, color);
  }
  return scene;
}

}  // namespace

void add_matching(PictureSheet& sheet,
                  const std::string& label,
                  const SparseShape& source,
                  const SparseShape& target,
                  const JudgedMatching& judged) {
  const Eigen::Matrix3d axes = view_axes(axis_frame('y'), View::kQuarter);
  PlacedPair pair = place_beside(
      scene_of(source), scene_of(target), Eigen::Matrix3d::Identity(), axes.row(0).transpose());
  const double unit = diagonal(source.mesh().V);
  for (size_t i = 0; i < judged.matching.matches.size(); ++i) {
    const Match& match = judged.matching.matches[i];
    const bool wrong = i < judged.errors.size() && judged.errors[i] > kWrong;
    pair.scene.rods.push_back({source.mesh().position(match.source_vertex),
                               pair.placed(target.mesh().position(match.target_vertex)),
                               (wrong ? 2.5 : 1) * kLineRadius * unit,
                               wrong ? Color(0.8F, 0, 0) : Color::Constant(0.2F)});
  }
  sheet.panels.push_back({static_cast<int>(sheet.scenes.size()), axes, label});
  sheet.scenes.push_back(std::move(pair.scene));
}

Status write_picture(const Bitmap& picture, const std::string& path) {
  const auto png = encode_png(picture);
  if (!png) return tl::unexpected(png.error());
  return write_output_files({{path, std::string(png->begin(), png->end())}});
}

Status write_sheet(const PictureSheet& sheet, int columns, const std::string& path) {
  constexpr int kWidth = 480, kHeight = 260;
  const int count = static_cast<int>(sheet.panels.size());
  if (count == 0) return {};
  const int wide = std::min(columns, count), high = (count + wide - 1) / wide;
  return write_picture(
      draw_figure(sheet.scenes,
                  sheet.panels,
                  {.width = kWidth * wide, .height = kHeight * high, .columns = wide}),
      path);
}

}  // namespace crosspatch
