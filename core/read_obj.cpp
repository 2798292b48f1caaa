// Wavefront OBJ, as described in the "Advanced Visualizer" manual, appendix B1.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "core/index.hpp"
#include "core/soup_formats.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {
namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();
/// Marks "no texture coordinate or normal here" among corner references.
constexpr int kNone = -1;

class ObjParser {
 public:
  ObjParser(std::filesystem::path folder, const ReadLimits& limits)
      : folder_(std::move(folder)), limits_(limits) {}

  Result<PolygonSoup> parse(std::string_view text) {
    LineReader lines(text);
    std::string joined;
    while (auto line = lines.next()) {
      std::string_view statement = *line;
      if (statement.ends_with('\\')) {  // continued on the next line
        joined.clear();
        while (line && line->ends_with('\\')) {
          joined.append(line->substr(0, line->size() - 1)).push_back(' ');
          line = lines.next();
        }
        if (line) joined.append(*line);
        statement = joined;
      }
      if (Status s = read_statement(statement); !s)
        return fail(s.error().code, fmt::format("line {}: {}", lines.number(), s.error().message));
    }
    return finish();
  }

 private:
  Status read_statement(std::string_view line) {
    line = without_comment(line);
    const std::string_view keyword = take_word(line);
    if (keyword == "v") return read_vertex(line);
    if (keyword == "vt") return read_numbers(line, 1, 3, "texture coordinate", vt_);
    if (keyword == "vn") return read_numbers(line, 3, 3, "normal", vn_);
    if (keyword == "f" || keyword == "fo") return read_face(line);
    if (keyword == "usemtl") use_material(trimmed(line));
    if (keyword == "mtllib") libraries_.emplace_back(trimmed(line));
    return {};  // groups, lines, points, smoothing, free-form surfaces: not part of a soup
  }

  /// Appends `most` numbers to `out`; those beyond the first `least` may be absent and are 0.
  static Status read_numbers(std::string_view line,
                             std::size_t least,
                             std::size_t most,
                             const char* what,
                             std::vector<double>& out) {
    for (std::size_t i = 0; i < most; ++i) {
      const std::string_view word = take_word(line);
      const auto value = word.empty() && i >= least ? 0.0 : to_double(word);
      if (!value || !std::isfinite(*value))
        return fail(ErrorCode::kBadInput,
                    fmt::format("{}: {} is not a finite number", what, in_quotes(word)));
      out.push_back(*value);
    }
    return {};
  }

  /// `v x y z`, `v x y z w` or `v x y z r g b`.
  Status read_vertex(std::string_view line) {
    if (Status s = read_numbers(line, 3, 3, "vertex", v_); !s) return s;
    std::string_view rest = line;
    for (int i = 0; i < 3; ++i) take_word(rest);
    std::string_view probe = rest;
    int extra = 0;
    while (!take_word(probe).empty()) ++extra;
    if (extra >= 3) {
      colors_.resize(v_.size() - 3, 1.0);
      return read_numbers(rest, 3, 3, "vertex colour", colors_);
    }
    return check_size(soup_, v_, limits_);
  }

  /// One of the up to three indices of a face corner; `count` things have been defined so far.
  static Result<int> read_index(std::string_view word, std::size_t count, const char* what) {
    const auto index = to_integer(word);
    const long long defined = static_cast<long long>(count);
    if (!index || *index == 0 || *index < -defined || *index > std::numeric_limits<int>::max())
      return fail(
          ErrorCode::kBadInput,
          fmt::format(
              "{} index {}: must be 1, 2, ... or -1 to -{}", what, in_quotes(word), defined));
    return static_cast<int>(*index > 0 ? *index - 1 : defined + *index);
  }

  Status read_face(std::string_view line) {
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      std::array<int, 3> ref{kNone, kNone, kNone};
      const std::array<std::size_t, 3> counts{v_.size() / 3, vt_.size() / 3, vn_.size() / 3};
      constexpr std::array<const char*, 3> kWhat{"vertex", "texture coordinate", "normal"};
      std::string_view rest = word;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view part = rest.substr(0, rest.find('/'));
        rest.remove_prefix(std::min(part.size() + 1, rest.size()));
        if (part.empty() && i > 0) continue;
        const auto index = read_index(part, counts[i], kWhat[i]);
        if (!index) return tl::unexpected(index.error());
        ref[i] = *index;
      }
      soup_.corner_vertex.push_back(ref[0]);
      corner_vt_.push_back(ref[1]);
      corner_vn_.push_back(ref[2]);
    }
    end_polygon(soup_);
    soup_.polygon_material.push_back(material_);
    return check_size(soup_, v_, limits_);
  }

  void use_material(std::string_view name) {
    const auto [it, fresh] =
        material_index_.try_emplace(std::string(name), static_cast<int>(soup_.materials.size()));
    if (fresh) soup_.materials.emplace_back().name = name;
    material_ = it->second;
  }

  /// Attaches entry corner[c] of `list` (three numbers each) to every corner through `add`.
  template <class Add>
  Status attach(const std::vector<double>& list,
                const std::vector<int>& corner,
                const char* what,
                Add add) {
    const int count = static_cast<int>(list.size() / 3);
    for (std::size_t c = 0; c < corner.size(); ++c) {
      if (corner[c] >= count)
        return fail(ErrorCode::kBadInput,
                    fmt::format("{} index {}: the file has {}", what, corner[c] + 1, count));
      add(corner[c] < 0 ? Vector3d(kUnset, kUnset, kUnset) : Vector3d(&list[3 * idx(corner[c])]));
    }
    return {};
  }

  Status attach_corner_data() {
    const auto used = [](const std::vector<int>& corner) {
      return std::any_of(corner.begin(), corner.end(), [](int i) { return i >= 0; });
    };
    if (used(corner_vt_) && vt_.empty())
      soup_.notes.emplace_back("faces name texture coordinates, the file has none");
    if (used(corner_vt_) && !vt_.empty()) {
      auto& uv = soup_.uv_sets.emplace_back();
      if (Status s = attach(vt_,
                            corner_vt_,
                            "texture coordinate",
                            [&](const Vector3d& t) { uv.emplace_back(t[0], 1 - t[1]); });
          !s)
        return s;
    }
    if (used(corner_vn_) && vn_.empty())
      soup_.notes.emplace_back("faces name normals, the file has none");
    if (used(corner_vn_) && !vn_.empty())
      if (Status s = attach(vn_,
                            corner_vn_,
                            "normal",
                            [&](const Vector3d& n) { soup_.corner_normals.push_back(n); });
          !s)
        return s;
    return {};
  }

  void attach_colors() {
    if (colors_.empty()) return;
    colors_.resize(v_.size(), 1.0);
    for (const int v : soup_.corner_vertex) {
      const double* c = &colors_[3 * idx(v)];
      soup_.corner_colors.push_back(
          {linear_from_srgb(c[0]), linear_from_srgb(c[1]), linear_from_srgb(c[2]), 1});
    }
  }

  Status read_libraries() {
    for (const std::string& written : libraries_) {
      // One name that may hold blanks, or several names.
      std::vector<std::string> names{written};
      if (!resolve_inside(folder_, written) && written.find(' ') != std::string::npos) {
        names.clear();
        std::string_view rest = written;
        for (auto word = take_word(rest); !word.empty(); word = take_word(rest))
          names.emplace_back(word);
      }
      for (const std::string& name : names) {
        const auto path = resolve_inside(folder_, name);
        if (!path) {
          soup_.notes.push_back("material library passed over: " + path.error().message);
          continue;
        }
        const auto bytes = read_file_bytes(*path, limits_.max_file_bytes);
        if (!bytes) return tl::unexpected(bytes.error());
        const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
        if (Status s = parse_mtl(text, folder_, limits_, soup_); !s) return s;
      }
    }
    return {};
  }

  Result<PolygonSoup> finish() {
    soup_.positions = as_positions(v_);
    for (std::size_t c = 0; c < soup_.corner_vertex.size(); ++c)
      if (soup_.corner_vertex[c] >= soup_.positions.rows())
        return fail(ErrorCode::kBadInput,
                    fmt::format("vertex index {}: the file has {} vertices",
                                soup_.corner_vertex[c] + 1LL,
                                soup_.positions.rows()));
    if (Status s = attach_corner_data(); !s) return tl::unexpected(s.error());
    attach_colors();
    if (soup_.materials.empty()) soup_.polygon_material.clear();
    if (Status s = read_libraries(); !s) return tl::unexpected(s.error());
    return std::move(soup_);
  }

  std::filesystem::path folder_;
  const ReadLimits& limits_;
  PolygonSoup soup_;
  std::vector<double> v_, vt_, vn_, colors_;  // three numbers each
  std::vector<int> corner_vt_, corner_vn_;    // one a corner
  std::vector<std::string> libraries_;
  std::map<std::string, int> material_index_;
  int material_ = -1;
};

}  // namespace

Result<PolygonSoup> parse_obj(std::string_view text,
                              const std::filesystem::path& folder,
                              const ReadLimits& limits) {
  return ObjParser(folder, limits).parse(text);
}

}  // namespace crosspatch
