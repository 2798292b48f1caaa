// crosspatch render: mesh files -> scenes -> figure -> PNG
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "tools/commands.hpp"
#include "tools/figure.hpp"
#include "tools/image_io.hpp"
#include "tools/input.hpp"
#include "tools/landmarks.hpp"
#include "tools/map_text.hpp"
#include "tools/output_files.hpp"
#include "tools/palette.hpp"
#include "tools/report.hpp"
#include "tools/scene_pair.hpp"
#include "tools/scene_surface.hpp"
#include "tools/text_lines.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// A mesh file on its way into the figure.
struct Drawn {
  std::string path;
  PolygonSoup soup;
  Scene scene;  ///< its first surface is the mesh, a face a fan triangle, with the file's vertices
  Frame frame = Frame::Identity();
  MatrixX3d marks{};  ///< the vertices that landmarks name, in their order

  [[nodiscard]] Surface& surface() { return scene.surfaces.front(); }
};

Result<Drawn> read_drawn(const std::string& path, DrawnColors colors, char up) {
  Result<PolygonSoup> soup = read_input_soup(path);
  if (!soup) return tl::unexpected(soup.error());
  Drawn drawn{path, std::move(*soup), {}, Frame::Identity(), {}};
  if (colors == DrawnColors::kOwn) {
    Result<Scene> scene = textured_scene(drawn.soup);
    if (!scene) return tl::unexpected(with_path(path, scene.error()));
    drawn.scene = std::move(*scene);
  } else {
    drawn.scene.surfaces.push_back(plain_surface(drawn.soup));
  }
  drawn.frame = up == 'p' ? principal_frame(drawn.soup.positions) : axis_frame(up);
  return drawn;
}

PairPattern pattern_of(DrawnColors colors) {
  return colors == DrawnColors::kChecker ? PairPattern::kChecker : PairPattern::kPosition;
}

/// Colours the first mesh by where the map file takes it, and turns the second the same way.
Status apply_map(const std::string& map_path, DrawnColors colors, Drawn& source, Drawn& target) {
  const Result<std::string> text = read_input_text(map_path);
  if (!text) return tl::unexpected(text.error());
  const auto map = parse_map(*text,
                             static_cast<int>(source.soup.positions.rows()),
                             static_cast<int>(target.surface().F.rows()));
  if (!map) return tl::unexpected(with_path(map_path, map.error()));
  const MatrixX3d& target_positions = target.surface().V;
  const MatrixX3d places = image_positions(*map, target_positions, target.surface().F);
  std::vector<Eigen::Index> mapped;
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    if (places.row(i).allFinite()) mapped.push_back(i);
  if (mapped.size() >= 3)  // fewer points fix no rotation
    target.frame = source.frame * best_rotation(places(mapped, Eigen::all),
                                                source.soup.positions(mapped, Eigen::all));
  if (colors != DrawnColors::kOwn)
    color_by_place(source.surface(), places, target_positions, pattern_of(colors));
  return {};
}

/// Balls at corresponding vertices, each pair in one colour.
Status add_landmarks(const std::string& path, std::vector<Drawn>& drawn) {
  const Result<std::string> text = read_input_text(path);
  if (!text) return tl::unexpected(text.error());
  const auto landmarks = parse_landmarks(*text,
                                         static_cast<int>(drawn.front().soup.positions.rows()),
                                         static_cast<int>(drawn.back().soup.positions.rows()));
  if (!landmarks) return tl::unexpected(with_path(path, landmarks.error()));
  constexpr double kRadius = 0.012;  // of the diagonal: seen in a panel, hides little
  for (size_t side = 0; side < drawn.size(); ++side) {
    Drawn& mesh = drawn[side];
    const MatrixX3d& V = mesh.soup.positions;
    mesh.marks.resize(static_cast<Eigen::Index>(landmarks->size()), 3);
    for (int i = 0; i < mesh.marks.rows(); ++i) {
      const FileLandmark& pair = (*landmarks)[static_cast<size_t>(i)];
      mesh.marks.row(i) = V.row(side == 0 ? pair.source_vertex : pair.target_vertex);
      add_points(mesh.scene, mesh.marks.row(i), kRadius * diagonal(V), category_color(i));
    }
  }
  return {};
}

Status add_field(const std::string& path, Drawn& drawn) {
  const Result<std::string> text = read_input_text(path);
  if (!text) return tl::unexpected(text.error());
  std::vector<double> values;
  for (const TextLine& line : text_lines(*text))
    for (const std::string_view word : line.words)
      if (!parse_number(word, values.emplace_back()))
        return fail(ErrorCode::kBadInput,
                    fmt::format("{}: line {}: not a number", path, line.number));
  const Eigen::Map<const Eigen::VectorXd> field(values.data(),
                                                static_cast<Eigen::Index>(values.size()));
  Surface& surface = drawn.surface();
  surface.face_texture.clear();
  if (field.size() == surface.V.rows())
    color_field(surface, field);
  else if (field.size() == surface.F.rows())
    color_heat(surface, field, {.low = field.minCoeff(), .high = field.maxCoeff()});
  else
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: {} numbers for {} vertices and {} triangles",
                            path,
                            field.size(),
                            surface.V.rows(),
                            surface.F.rows()));
  return {};
}

std::string label(const Drawn& mesh, View view) {
  return fmt::format("{} {}", std::filesystem::path(mesh.path).stem().string(), view_name(view));
}

/// Columns that make a figure of that many panels about as wide as high.
int square_columns(size_t panels) {
  return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(panels))));
}

/// A row of panels for each of two meshes; one mesh fills a square.
Bitmap draw_meshes(std::vector<Drawn>& drawn, const RenderArguments& arguments) {
  std::vector<Scene> scenes;
  std::vector<Panel> panels;
  for (size_t i = 0; i < drawn.size(); ++i) {
    for (const View view : arguments.views)
      panels.push_back(
          {static_cast<int>(i), view_axes(drawn[i].frame, view), label(drawn[i], view)});
    scenes.push_back(std::move(drawn[i].scene));
  }
  const int columns =
      drawn.size() == 1 ? square_columns(panels.size()) : static_cast<int>(arguments.views.size());
  return draw_figure(
      scenes, panels, {.width = arguments.width, .height = arguments.height, .columns = columns});
}

/// A panel a view with both meshes side by side and lines between their landmarks.
Bitmap draw_side_by_side(const std::vector<Drawn>& drawn, const RenderArguments& arguments) {
  constexpr double kLineRadius = 0.0015;  // of the diagonal: about two pixels in a panel
  const Drawn &first = drawn.front(), &second = drawn.back();
  const Eigen::Matrix3d turn = first.frame.transpose() * second.frame;
  std::vector<Scene> scenes;
  std::vector<Panel> panels;
  for (const View view : arguments.views) {
    const Eigen::Matrix3d axes = view_axes(first.frame, view);
    PlacedPair pair = place_beside(first.scene, second.scene, turn, axes.row(0).transpose());
    MatrixX3d ends = second.marks;
    for (auto end : ends.rowwise()) end = pair.placed(end.transpose()).transpose();
    add_correspondences(
        pair.scene, first.marks, ends, kLineRadius * diagonal(first.soup.positions));
    panels.push_back({static_cast<int>(scenes.size()), axes, label(first, view)});
    scenes.push_back(std::move(pair.scene));
  }
  return draw_figure(scenes,
                     panels,
                     {.width = arguments.width,
                      .height = arguments.height,
                      .columns = square_columns(panels.size())});
}

/// Reads the meshes and dresses them as the arguments say.
Result<std::vector<Drawn>> read_scenes(const RenderArguments& arguments) {
  const DrawnColors colors =
      arguments.colors.value_or(arguments.map.empty() ? DrawnColors::kOwn : DrawnColors::kPosition);
  std::vector<Drawn> drawn;
  for (const std::string& path : {arguments.mesh, arguments.mesh2}) {
    if (path.empty()) continue;
    Result<Drawn> one = read_drawn(path, colors, arguments.up);
    if (!one) return tl::unexpected(one.error());
    drawn.push_back(std::move(*one));
    Drawn& added = drawn.back();
    if (colors != DrawnColors::kOwn)
      color_by_place(
          added.surface(), added.soup.positions, added.soup.positions, pattern_of(colors));
  }
  if (!arguments.map.empty())
    if (const Status s = apply_map(arguments.map, colors, drawn[0], drawn[1]); !s)
      return tl::unexpected(s.error());
  if (!arguments.field.empty())
    if (const Status s = add_field(arguments.field, drawn[0]); !s) return tl::unexpected(s.error());
  if (!arguments.landmarks.empty())
    if (const Status s = add_landmarks(arguments.landmarks, drawn); !s)
      return tl::unexpected(s.error());
  return drawn;
}

}  // namespace

Result<ExitCode> run(const RenderArguments& arguments) {
  Progress progress(arguments.common.quiet, 2);
  progress.begin("read");
  Result<std::vector<Drawn>> drawn = read_scenes(arguments);
  if (!drawn) return tl::unexpected(drawn.error());
  RunReport report{.command = "render"};
  int triangles = 0;
  for (Drawn& mesh : *drawn) {
    report.inputs.push_back(summarize("mesh", mesh.path, mesh.soup));
    triangles += static_cast<int>(mesh.surface().F.rows());
  }
  progress.end(fmt::format("{} meshes, {} triangles", drawn->size(), triangles));

  progress.begin("draw");
  const Bitmap picture =
      arguments.lines ? draw_side_by_side(*drawn, arguments) : draw_meshes(*drawn, arguments);
  const auto png = encode_png(picture);
  if (!png) return tl::unexpected(png.error());
  progress.end(fmt::format("{} x {} pixels", picture.width, picture.height));

  std::vector<OutputFile> outputs = {{arguments.output, std::string(png->begin(), png->end())}};
  if (!arguments.common.json.empty()) {
    for (const std::string& path : {arguments.map, arguments.landmarks, arguments.field})
      if (!path.empty()) report.other_inputs.push_back(path);
    report.options = {{"size", fmt::format("{}x{}", arguments.width, arguments.height)},
                      {"up", std::string(1, arguments.up)}};
    report.stages = progress.records();
    report.outputs = {arguments.output};
    outputs.push_back({arguments.common.json, report_json(report)});
  }
  if (const Status written = write_output_files(outputs); !written)
    return tl::unexpected(written.error());
  return ExitCode::kDone;
}

}  // namespace crosspatch
