#include "core/read_soup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <new>

#include "core/image_header.hpp"
#include "core/soup_formats.hpp"

namespace crosspatch {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return extension;
}

Result<PolygonSoup> parse(const std::filesystem::path& path, const ReadLimits& limits) {
  const std::string extension = lower_extension(path);
  if (extension != ".obj" && extension != ".ply" && extension != ".off" && extension != ".stl")
    return fail(ErrorCode::kBadInput,
                fmt::format("extension {} is none of .obj .ply .off .stl", in_quotes(extension)));
  const auto bytes = read_file_bytes(path, limits.max_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  if (extension == ".obj") return parse_obj(text, path.parent_path(), limits);
  if (extension == ".ply") return parse_ply(text, path.parent_path(), limits);
  if (extension == ".off") return parse_off(text, limits);
  return parse_stl(text, limits);
}

}  // namespace

Result<PolygonSoup> read_soup(const std::filesystem::path& path, const ReadLimits& limits) {
  const std::string name = in_quotes(path.filename().string());
  try {
    Result<PolygonSoup> soup = parse(path, limits);
    if (soup && soup->polygon_count() == 0)
      soup = fail(ErrorCode::kBadInput, "the file holds no polygons");
    if (soup)
      if (Status valid = validate(*soup); !valid) soup = tl::unexpected(valid.error());
    if (!soup)
      return fail(soup.error().code, fmt::format("file {}: {}", name, soup.error().message));
    return soup;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kInternal, fmt::format("file {}: not enough memory", name));
  } catch (const std::exception& e) {
    return fail(ErrorCode::kBadInput, fmt::format("file {}: {}", name, e.what()));
  }
}

Status check_size(const PolygonSoup& soup,
                  const std::vector<double>& coordinates,
                  const ReadLimits& limits) {
  if (static_cast<std::int64_t>(coordinates.size()) > 3 * limits.max_vertices)
    return fail(ErrorCode::kBadInput, fmt::format("more than {} vertices", limits.max_vertices));
  if (static_cast<std::int64_t>(soup.corner_vertex.size()) > 3 * limits.max_triangles ||
      soup.polygon_count() > limits.max_triangles)
    return fail(ErrorCode::kBadInput,
                fmt::format("polygons of more than {} triangles", limits.max_triangles));
  return {};
}

MatrixX3d as_positions(const std::vector<double>& coordinates) {
  return Eigen::Map<const MatrixX3d>(
      coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
}

float linear_from_srgb(double value) {
  const double c = std::clamp(value, 0.0, 1.0);
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

Result<int> add_image(std::string_view name,
                      const std::filesystem::path& folder,
                      const ReadLimits& limits,
                      PolygonSoup& soup) {
  const auto path = resolve_inside(folder, name);
  if (!path) {
    soup.notes.push_back("image passed over: " + path.error().message);
    return -1;
  }
  const std::string key = path->filename().string();
  auto bytes = read_file_bytes(*path, limits.max_image_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  for (std::size_t i = 0; i < soup.images.size(); ++i)
    if (soup.images[i].name == key && soup.images[i].bytes == *bytes) return static_cast<int>(i);
  auto image = make_image_file(key, std::move(*bytes), limits);
  if (!image) return tl::unexpected(image.error());
  if (image->mime_type.empty())
    soup.notes.push_back(
        fmt::format("image {} is neither PNG nor JPEG: kept undecoded", in_quotes(key)));
  soup.images.push_back(std::move(*image));
  return static_cast<int>(soup.images.size()) - 1;
}

}  // namespace crosspatch
