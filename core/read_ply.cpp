// Polygon File Format (Turk 1994), ASCII and binary, with the texture conventions of MeshLab:
// `comment TextureFile`, face lists `texcoord` (u v of each corner) and `texnumber`.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/ply_body.hpp"
#include "core/soup_formats.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {
namespace {

class PlyParser {
 public:
  PlyParser(const PlyHeader& header, const std::filesystem::path& folder, const ReadLimits& limits)
      : header_(header), folder_(folder), limits_(limits), body_(header) {}

  Result<PolygonSoup> parse() {
    for (const PlyElement& element : header_.elements) {
      const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
      if (element.name == "tristrips")
        return fail(ErrorCode::kBadInput, "triangle strips in PLY are not read");
      if (is_vertex)
        if (Status s = begin_vertices(element); !s) return tl::unexpected(s.error());
      for (long long i = 0; i < element.count; ++i) {
        const Status s = is_vertex ? read_vertex(element)
                         : is_face ? read_face(element)
                                   : skip(element);
        if (!s)
          return fail(
              s.error().code,
              fmt::format(
                  "{} {} (counted from 0): {}", in_quotes(element.name), i, s.error().message));
      }
    }
    return finish();
  }

 private:
  static tl::unexpected<Error> no_number(const PlyProperty& property) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: no finite number, or the file ends", in_quotes(property.name)));
  }

  /// The values of one property: a list's, or a single one. Filled into values_.
  Status read_values(const PlyProperty& property) {
    values_.clear();
    long long count = 1;
    if (property.is_list) {
      const auto declared = body_.take(property.count_type);
      if (!declared || !(*declared >= 0) || *declared != std::floor(*declared) ||
          *declared > static_cast<double>(body_.bytes_left()))
        return fail(ErrorCode::kBadInput,
                    fmt::format("{}: list length {} does not fit the {} bytes left",
                                in_quotes(property.name),
                                declared.value_or(-1),
                                body_.bytes_left()));
      count = static_cast<long long>(*declared);
    }
    for (long long i = 0; i < count; ++i) {
      const auto value = body_.take(property.type);
      if (!value) return no_number(property);
      values_.push_back(*value);
    }
    return {};
  }

  Status begin_vertices(const PlyElement& element) {
    if (!slots_.empty()) return fail(ErrorCode::kBadInput, "element 'vertex' comes twice");
    for (const PlyProperty& p : element.properties) {
      slots_.push_back(p.is_list ? kIgnored : ply_vertex_slot(p.name));
      if (slots_.back() == kIgnored) continue;
      has_slot_[slots_.back()] = true;
      if (slots_.back() == kRed && p.type == PlyType::kUint8) color_scale_ = 255;
      if (slots_.back() == kRed && p.type == PlyType::kUint16) color_scale_ = 65535;
    }
    if (!has_slot_[kX] || !has_slot_[kY] || !has_slot_[kZ])
      return fail(ErrorCode::kBadInput, "element 'vertex' lacks one of x, y, z");
    return {};
  }

  Status read_vertex(const PlyElement& element) {
    std::array<double, kSlots> vertex{};
    vertex[kAlpha] = color_scale_;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (Status s = read_values(element.properties[i]); !s) return s;
      if (slots_[i] == kIgnored) continue;
      if (!std::isfinite(values_[0])) return no_number(element.properties[i]);
      vertex[slots_[i]] = values_[0];
    }
    coordinates_.insert(coordinates_.end(), vertex.begin(), vertex.begin() + 3);
    if (has_slot_[kNx] && has_slot_[kNy] && has_slot_[kNz])
      normals_.emplace_back(vertex[kNx], vertex[kNy], vertex[kNz]);
    if (has_slot_[kU] && has_slot_[kV]) uv_.emplace_back(vertex[kU], 1 - vertex[kV]);
    if (has_slot_[kRed] && has_slot_[kGreen] && has_slot_[kBlue])
      colors_.push_back({linear_from_srgb(vertex[kRed] / color_scale_),
                         linear_from_srgb(vertex[kGreen] / color_scale_),
                         linear_from_srgb(vertex[kBlue] / color_scale_),
                         static_cast<float>(vertex[kAlpha] / color_scale_)});
    return check_size(soup_, coordinates_, limits_);
  }

  Status read_face(const PlyElement& element) {
    std::vector<double> corner_uv;
    int texture = header_.texture_files.empty() ? -1 : 0;
    const std::size_t begin = soup_.corner_vertex.size();
    for (const PlyProperty& p : element.properties) {
      if (Status s = read_values(p); !s) return s;
      if (p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index")) {
        for (const double v : values_) {
          if (!(v >= 0) || v > std::numeric_limits<int>::max() || v != std::floor(v))
            return fail(ErrorCode::kBadInput, fmt::format("vertex {} is no index", v));
          soup_.corner_vertex.push_back(static_cast<int>(v));
        }
      } else if (p.is_list && p.name == "texcoord") {
        corner_uv = values_;
      } else if (p.name == "texnumber" && !values_.empty()) {
        const double last = static_cast<double>(header_.texture_files.size()) - 1;
        texture = values_[0] >= 0 && values_[0] <= last ? static_cast<int>(values_[0]) : -1;
      }
    }
    end_polygon(soup_);
    soup_.polygon_material.push_back(texture);
    const std::size_t corners = soup_.corner_vertex.size() - begin;
    constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t k = 0; k < corners; ++k)
      if (corner_uv.size() == 2 * corners && std::isfinite(corner_uv[2 * k]) &&
          std::isfinite(corner_uv[2 * k + 1]))
        corner_uv_.emplace_back(corner_uv[2 * k], 1 - corner_uv[2 * k + 1]);
      else
        corner_uv_.emplace_back(kUnset, kUnset);
    has_corner_uv_ = has_corner_uv_ || (corners > 0 && corner_uv.size() == 2 * corners);
    return check_size(soup_, coordinates_, limits_);
  }

  Status skip(const PlyElement& element) {
    for (const PlyProperty& p : element.properties)
      if (Status s = read_values(p); !s) return s;
    return {};
  }

  /// One entry a corner out of one a vertex; corners are known to be in range.
  template <class T>
  std::vector<T> per_corner(const std::vector<T>& per_vertex) const {
    std::vector<T> out;
    if (per_vertex.empty()) return out;
    for (const int v : soup_.corner_vertex) out.push_back(per_vertex[static_cast<std::size_t>(v)]);
    return out;
  }

  Result<PolygonSoup> finish() {
    soup_.positions = as_positions(coordinates_);
    if (Status s = validate_corners(); !s) return tl::unexpected(s.error());
    if (has_corner_uv_)
      soup_.uv_sets.push_back(std::move(corner_uv_));
    else if (!uv_.empty())
      soup_.uv_sets.push_back(per_corner(uv_));
    soup_.corner_normals = per_corner(normals_);
    soup_.corner_colors = per_corner(colors_);
    if (header_.texture_files.empty()) soup_.polygon_material.clear();
    for (const std::string& file : header_.texture_files) {
      const auto image = add_image(file, folder_, limits_, soup_);
      if (!image) return tl::unexpected(image.error());
      Material& material = soup_.materials.emplace_back();
      material.name = file;
      material.base_color.image = *image;
    }
    return std::move(soup_);
  }

  [[nodiscard]] Status validate_corners() const {
    for (const int v : soup_.corner_vertex)
      if (v >= soup_.positions.rows())
        return fail(ErrorCode::kBadInput,
                    fmt::format("vertex {} is outside [0, {})", v, soup_.positions.rows()));
    return {};
  }

  const PlyHeader& header_;
  const std::filesystem::path& folder_;
  const ReadLimits& limits_;
  PlyBody body_;
  PolygonSoup soup_;
  std::vector<PlyVertexSlot> slots_;  // of the vertex element's properties
  std::array<bool, kSlots> has_slot_{};
  double color_scale_ = 1;
  std::vector<double> values_, coordinates_;
  std::vector<Vector3d> normals_;
  std::vector<Vector2d> uv_;
  std::vector<std::array<float, 4>> colors_;
  std::vector<Vector2d> corner_uv_;
  bool has_corner_uv_ = false;
};

}  // namespace

Result<PolygonSoup> parse_ply(std::string_view bytes,
                              const std::filesystem::path& folder,
                              const ReadLimits& limits) {
  const auto header = read_ply_header(bytes);
  if (!header) return tl::unexpected(header.error());
  return PlyParser(*header, folder, limits).parse();
}

}  // namespace crosspatch
