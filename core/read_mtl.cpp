// Wavefront MTL with the usual PBR additions (Pr, Pm, map_Pr, map_Pm, norm), expressed as glTF
// 2.0 metallic-roughness materials.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/soup_formats.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {
namespace {

constexpr int kClampToEdge = 33071;

/// A `map_...` statement: options, then a file name that may hold blanks.
struct MapStatement {
  std::string_view file;
  Vector2d scale{1, 1}, offset{0, 0};
  bool clamp = false;
  double bump = 1;

  /// The texture coordinate transform in glTF's convention: u' = s u + o with v upwards becomes
  /// v' = s v + (1 - s - o) with v downwards.
  [[nodiscard]] std::optional<TextureTransform> transform() const {
    if (scale == Vector2d(1, 1) && offset == Vector2d(0, 0)) return std::nullopt;
    return TextureTransform{{offset[0], 1 - scale[1] - offset[1]}, 0, scale};
  }
};

MapStatement parse_map(std::string_view rest) {
  MapStatement map;
  while (true) {
    rest = trimmed(rest);
    std::string_view after = rest;
    const std::string_view option = take_word(after);
    if (option.size() < 2 || option[0] != '-') break;
    // Up to three numbers, or one word, belong to an option.
    std::array<double, 3> values{1, 1, 1};
    int count = 0;
    std::string_view next = after;
    for (auto value = to_double(take_word(next)); value && count < 3;
         value = to_double(take_word(next))) {
      values[static_cast<std::size_t>(count++)] = std::isfinite(*value) ? *value : 1;
      after = next;
    }
    if (count == 0) {
      const std::string_view word = take_word(after);
      if (option == "-clamp") map.clamp = word == "on";
    }
    if (option == "-bm" && count > 0) map.bump = values[0];
    if (option == "-s" && count > 0) map.scale = {values[0], count > 1 ? values[1] : 1};
    if (option == "-o" && count > 0) map.offset = {values[0], count > 1 ? values[1] : 0};
    rest = after;
  }
  map.file = rest;
  return map;
}

class MtlParser {
 public:
  MtlParser(const std::filesystem::path& folder, const ReadLimits& limits, PolygonSoup& soup)
      : folder_(folder), limits_(limits), soup_(soup) {}

  Status parse(std::string_view text) {
    LineReader lines(text);
    while (auto line = lines.next()) {
      std::string_view rest = trimmed(without_comment(*line));
      const std::string_view keyword = take_word(rest);
      if (keyword == "newmtl") {
        begin_material(trimmed(rest));
      } else if (material_ != nullptr) {
        if (Status s = read_statement(keyword, rest); !s)
          return fail(
              s.error().code,
              fmt::format("material library line {}: {}", lines.number(), s.error().message));
      }
    }
    return {};
  }

 private:
  void begin_material(std::string_view name) {
    material_ = nullptr;  // defined, but used by no face
    for (Material& m : soup_.materials)
      if (m.name == name) material_ = &m;
    has_normal_map_ = false;
  }

  Status read_statement(std::string_view keyword, std::string_view rest) {
    Material& m = *material_;
    // Exporters disagree on whether a colour multiplies its image, and many write black beside
    // one: the image alone counts.
    if (keyword == "Kd" && m.base_color.image < 0)
      return read_color(rest, m.base_color_factor.data());
    if (keyword == "Ke" && m.emissive.image < 0) return read_color(rest, m.emissive_factor.data());
    if (keyword == "d" || keyword == "Tr") return read_opacity(rest, keyword == "Tr");
    if (keyword == "Pr") return read_unit(rest, m.roughness_factor);
    if (keyword == "Pm") return read_unit(rest, m.metallic_factor);
    if (keyword == "map_Kd") {
      if (Status s = read_map(rest, m.base_color); !s) return s;
      if (m.base_color.image >= 0) std::fill_n(m.base_color_factor.begin(), 3, 1.0);
    }
    if (keyword == "map_Ke") {
      if (Status s = read_map(rest, m.emissive); !s) return s;
      if (m.emissive.image >= 0) m.emissive_factor.fill(1);
    }
    if (keyword == "norm") {
      has_normal_map_ = true;
      return read_map(rest, m.normal);
    }
    if ((keyword == "map_Bump" || keyword == "map_bump" || keyword == "bump") && !has_normal_map_) {
      soup_.notes.push_back(
          fmt::format("material {}: {} is read as a normal map", in_quotes(m.name), keyword));
      return read_map(rest, m.normal);
    }
    return {};
  }

  /// Up to three values; one alone is grey.
  static Status read_color(std::string_view rest, double* color) {
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = take_word(rest);
      if (word.empty() && i > 0) {
        color[i] = color[i - 1];
        continue;
      }
      const auto value = to_double(word);
      if (!value || !std::isfinite(*value))
        return fail(ErrorCode::kBadInput,
                    fmt::format("{} is not a finite number", in_quotes(word)));
      color[i] = std::clamp(*value, 0.0, 1.0);
    }
    return {};
  }

  static Status read_unit(std::string_view rest, double& value) {
    double color[3];
    if (Status s = read_color(rest, color); !s) return s;
    value = color[0];
    return {};
  }

  Status read_opacity(std::string_view rest, bool inverted) {
    double value = 1;
    if (rest.find("-halo") != std::string_view::npos) return {};
    if (Status s = read_unit(rest, value); !s) return s;
    material_->base_color_factor[3] = inverted ? 1 - value : value;
    material_->alpha_mode = material_->base_color_factor[3] < 1 ? "BLEND" : "OPAQUE";
    return {};
  }

  Status read_map(std::string_view rest, TextureRef& ref) {
    const MapStatement map = parse_map(rest);
    const auto image = add_image(map.file, folder_, limits_, soup_);
    if (!image) return tl::unexpected(image.error());
    ref = TextureRef{.image = *image, .strength = map.bump, .transform = map.transform()};
    if (map.clamp) ref.wrap_s = ref.wrap_t = kClampToEdge;
    return {};
  }

  const std::filesystem::path& folder_;
  const ReadLimits& limits_;
  PolygonSoup& soup_;
  Material* material_ = nullptr;
  bool has_normal_map_ = false;
};

}  // namespace

Status parse_mtl(std::string_view text,
                 const std::filesystem::path& folder,
                 const ReadLimits& limits,
                 PolygonSoup& soup) {
  return MtlParser(folder, limits, soup).parse(text);
}

}  // namespace crosspatch
