#include "tools/source_texture.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/file_bytes.hpp"
#include "core/image_header.hpp"
#include "core/index.hpp"
#include "tools/image_io.hpp"
#include "tools/input.hpp"
#include "tools/palette.hpp"

namespace crosspatch {
namespace {

constexpr int kSize = 1024;  ///< texels of a side of painted images

/// Squares, every one with its own hue across and lightness down, so that no two look alike.
Bitmap checker() {
  constexpr int kSquares = 32;
  Bitmap bitmap = make_bitmap(kSize, kSize, Color::Zero());
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const int i = x * kSquares / kSize, j = y * kSquares / kSize;
      const float u = static_cast<float>(i) / kSquares, v = static_cast<float>(j) / kSquares;
      const Color tint(0.9F - 0.7F * u, 0.25F + 0.6F * v, 0.2F + 0.7F * u);
      set_pixel(bitmap, x, y, (i + j) % 2 == 0 ? tint : Color(0.25F * tint));
    }
  return bitmap;
}

/// Red grows with u, green with v; lines every tenth.
Bitmap uv_ramp() {
  constexpr int kStep = kSize / 10;
  Bitmap bitmap = make_bitmap(kSize, kSize, Color::Zero());
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const bool line = x % kStep < 2 || y % kStep < 2;
      set_pixel(bitmap,
                x,
                y,
                line ? Color(0, 0, 0)
                     : Color(static_cast<float>(x) / kSize, static_cast<float>(y) / kSize, 0.2F));
    }
  return bitmap;
}

Result<ImageFile> texture_image(const std::string& what) {
  if (what == "checker" || what == "uv")
    return encode_png(what == "checker" ? checker() : uv_ramp())
        .and_then([&](std::vector<unsigned char> bytes) {
          return make_image_file(what + ".png", std::move(bytes));
        });
  const std::string name = std::filesystem::path(what).filename().string();
  auto bytes = read_file_bytes(what, ReadLimits{}.max_image_bytes);
  if (!bytes) return tl::unexpected(with_path(what, bytes.error()));
  auto image = make_image_file(name, std::move(*bytes));
  if (!image) return tl::unexpected(with_path(what, image.error()));
  if (image->mime_type.empty())
    return fail(ErrorCode::kBadInput, fmt::format("{}: neither PNG nor JPEG", what));
  return image;
}

/// Colours by place in the bounding box, alike in all directions.
void color_by_position(PolygonSoup& soup) {
  const Eigen::RowVector3d low = soup.positions.colwise().minCoeff();
  const double size = (soup.positions.colwise().maxCoeff() - low).maxCoeff();
  soup.corner_colors.clear();
  for (const int v : soup.corner_vertex) {
    const Eigen::RowVector3d p = size > 0 ? Eigen::RowVector3d((soup.positions.row(v) - low) / size)
                                          : Eigen::RowVector3d::Zero();
    soup.corner_colors.push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), 1.0F});
  }
}

}  // namespace

Status give_texture(const std::string& what, PolygonSoup& soup) {
  Material material;
  const bool by_vertex = what == "position" || what == "distortion";
  material.name = by_vertex ? what : "texture";
  if (by_vertex) {
    if (what == "position")
      color_by_position(soup);
    else
      soup.corner_colors.assign(soup.corner_vertex.size(), {1, 1, 1, 1});
    soup.images.clear();
  } else {
    if (soup.uv_sets.empty())
      return fail(
          ErrorCode::kBadInput,
          fmt::format("--texture {}: the source has no texture coordinates; 'position' needs "
                      "none",
                      what));
    auto image = texture_image(what);
    if (!image) return tl::unexpected(image.error());
    soup.images = {std::move(*image)};
    material.base_color.image = 0;
    soup.corner_colors.clear();
  }
  soup.materials = {material};
  soup.polygon_material.assign(static_cast<std::size_t>(soup.polygon_count()), 0);
  return {};
}

void color_by_distortion(const FileNumbering& numbering,
                         const Eigen::VectorXd& energy,
                         PolygonSoup& soup) {
  for (std::size_t c = 0; c < soup.corner_vertex.size(); ++c) {
    const int v = numbering.mesh_vertex[idx(soup.corner_vertex[c])];
    if (v < 0) continue;
    const Color color = heat_color(distortion_place(energy[v]));
    soup.corner_colors[c] = {color[0], color[1], color[2], 1};
  }
}

}  // namespace crosspatch
