#include "tools/field_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/file_bytes.hpp"
#include "core/index.hpp"
#include "core/ply_columns.hpp"
#include "core/text_scanner.hpp"

namespace crosspatch {
namespace {

constexpr std::string_view kLabel = "label:", kTangent = "tangent:";
constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

/// A column as it was read.
struct Column {
  std::string name;
  bool is_label = false;
  std::vector<double> values;
};

bool is_label_value(double value) {
  return value == std::floor(value) && value >= std::numeric_limits<std::int32_t>::min() &&
         value <= std::numeric_limits<std::int32_t>::max();
}

Eigen::VectorXd as_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// The columns that make up the tangent field of which one component has that name; empty if one
/// is missing.
std::vector<const Column*> components(const std::vector<Column>& columns, const std::string& name) {
  std::vector<const Column*> found;
  if (name.size() < 2 || (name[name.size() - 2] != '.' && name[name.size() - 2] != '_')) return {};
  for (const char axis : {'x', 'y', 'z'}) {
    const std::string wanted = name.substr(0, name.size() - 1) + axis;
    for (const Column& c : columns)
      if (c.name == wanted) found.push_back(&c);
  }
  return found.size() == 3 ? found : std::vector<const Column*>{};
}

/// Makes fields of columns; kBadInput names the column that fits no rule.
Result<std::vector<VertexField>> fields_of(const std::vector<Column>& columns) {
  std::vector<VertexField> fields;
  std::set<std::string> used;
  for (const Column& column : columns) {
    if (column.name.empty()) return fail(ErrorCode::kBadInput, "a column has no name");
    if (!column.name.starts_with(kTangent)) {
      if (!used.insert(column.name).second)
        return fail(ErrorCode::kBadInput,
                    fmt::format("column {} comes twice", in_quotes(column.name)));
      fields.push_back({column.is_label ? FieldKind::kLabel : FieldKind::kNumber,
                        {column.name},
                        as_vector(column.values)});
      continue;
    }
    if (used.contains(column.name)) continue;
    const std::vector<const Column*> parts = components(columns, column.name);
    if (parts.empty())
      return fail(ErrorCode::kBadInput,
                  fmt::format("column {}: a tangent field has one column each that ends in .x, .y "
                              "and .z",
                              in_quotes(column.name)));
    VertexField field{FieldKind::kTangent, {}, {}};
    field.values.resize(static_cast<Eigen::Index>(column.values.size()), 3);
    for (const Column* part : parts) {
      used.insert(part->name);
      field.values.col(static_cast<Eigen::Index>(field.columns.size())) = as_vector(part->values);
      field.columns.push_back(part->name);
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

/// The cells of a line; nothing where a quote is left open.
std::optional<std::vector<std::string>> cells(std::string_view line) {
  std::vector<std::string> result(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        result.back() += line[i++];
      else
        quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      result.emplace_back();
    } else {
      result.back() += line[i];
    }
  }
  if (quoted) return std::nullopt;
  for (std::string& cell : result) cell = trimmed(cell);
  return result;
}

Status take_cell(const std::string& cell, long long line, Column& column) {
  const auto bad = [&](const char* reason) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format(
            "line {}: column {}: {} {}", line, in_quotes(column.name), in_quotes(cell), reason));
  };
  if (cell.empty()) {
    column.values.push_back(column.is_label ? kNoLabel : kUnset);
    return {};
  }
  const std::optional<double> value = to_double(cell);
  if (!value) return bad("is no number");
  if (column.is_label && !is_label_value(*value)) return bad("is no whole number of 32 bits");
  if (std::isinf(*value)) return bad("is not finite");
  column.values.push_back(*value);
  return {};
}

std::string quoted_if_needed(const std::string& name) {
  if (name.find_first_of(",\"") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) text.append(c == '"' ? 2 : 1, c);
  return text + '"';
}

/// Visits the fields' columns in their order: visit(field, column of its values).
template <class Visit>
void for_each_column(const std::vector<VertexField>& fields, Visit visit) {
  for (const VertexField& field : fields)
    for (Eigen::Index k = 0; k < field.values.cols(); ++k) visit(field, k);
}

/// 17 digits read back as the same double.
void append_value(std::string& text, const VertexField& field, double value, const char* none) {
  if (field.kind == FieldKind::kLabel)
    fmt::format_to(std::back_inserter(text), "{}", static_cast<std::int64_t>(value));
  else if (std::isnan(value))
    text += none;
  else
    fmt::format_to(std::back_inserter(text), "{:.17g}", value);
}

}  // namespace

Result<std::vector<VertexField>> parse_fields_csv(std::string_view text, int vertices) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  LineReader lines(text);
  std::vector<Column> columns;
  while (const std::optional<std::string_view> line = lines.next()) {
    // An empty line is a row of one column without a value, but for those at the file's end.
    const bool is_row = columns.size() == 1 && columns[0].values.size() < idx(vertices);
    if (trimmed(*line).empty() && !is_row) continue;
    const auto row = cells(*line);
    if (!row)
      return fail(ErrorCode::kBadInput,
                  fmt::format("line {}: a quote is left open", lines.number()));
    if (columns.empty()) {
      for (const std::string& name : *row)
        columns.push_back({name, std::string_view(name).starts_with(kLabel), {}});
      continue;
    }
    if (row->size() != columns.size())
      return fail(ErrorCode::kBadInput,
                  fmt::format("line {}: {} cells under a header of {}",
                              lines.number(),
                              row->size(),
                              columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (Status s = take_cell((*row)[i], lines.number(), columns[i]); !s)
        return tl::unexpected(s.error());
  }
  if (columns.empty()) return fail(ErrorCode::kBadInput, "is empty, a header is needed");
  if (columns[0].values.size() != idx(vertices))
    return fail(ErrorCode::kBadInput,
                fmt::format("{} rows for {} vertices", columns[0].values.size(), vertices));
  return fields_of(columns);
}

Result<std::vector<VertexField>> parse_fields_ply(std::string_view bytes, int vertices) {
  Result<PlyVertexColumns> read = read_ply_columns(bytes);
  if (!read) return tl::unexpected(read.error());
  if (read->vertex_count != vertices)
    return fail(ErrorCode::kBadInput,
                fmt::format("{} vertices, the source has {}", read->vertex_count, vertices));
  if (read->columns.empty())
    return fail(ErrorCode::kBadInput,
                "its vertices have no properties but those of the mesh and its look");
  std::vector<Column> columns;
  for (PlyColumn& c : read->columns) {
    const bool is_integer = c.type != PlyType::kFloat32 && c.type != PlyType::kFloat64;
    columns.push_back({std::move(c.name), is_integer, std::move(c.values)});
    Column& column = columns.back();
    column.is_label = column.is_label || column.name.starts_with(kLabel);
    if (column.name.starts_with(kTangent)) column.is_label = false;
    if (!column.is_label) continue;
    const auto wrong = std::find_if_not(column.values.begin(), column.values.end(), is_label_value);
    if (wrong != column.values.end())
      return fail(
          ErrorCode::kBadInput,
          fmt::format(
              "column {}: {} is no whole number of 32 bits", in_quotes(column.name), *wrong));
  }
  return fields_of(columns);
}

std::string fields_csv(const std::vector<VertexField>& fields) {
  std::string text;
  for_each_column(fields, [&](const VertexField& field, Eigen::Index k) {
    if (!text.empty()) text += ',';
    text += quoted_if_needed(field.columns[idx(k)]);
  });
  text += '\n';
  const Eigen::Index rows = fields.empty() ? 0 : fields[0].values.rows();
  for (Eigen::Index i = 0; i < rows; ++i) {
    const char* separator = "";
    for_each_column(fields, [&](const VertexField& field, Eigen::Index k) {
      text += separator;
      append_value(text, field, field.values(i, k), "");
      separator = ",";
    });
    text += '\n';
  }
  return text;
}

std::string fields_ply(const std::vector<VertexField>& fields, const PolygonSoup& mesh) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment crosspatch\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n",
      mesh.positions.rows());
  for_each_column(fields, [&](const VertexField& field, Eigen::Index k) {
    std::string name = field.columns[idx(k)];
    std::replace(name.begin(), name.end(), ' ', '_');
    text +=
        fmt::format("property {} {}\n", field.kind == FieldKind::kLabel ? "int" : "double", name);
  });
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                      mesh.polygon_count());
  for (Eigen::Index i = 0; i < mesh.positions.rows(); ++i) {
    fmt::format_to(std::back_inserter(text),
                   "{:.17g} {:.17g} {:.17g}",
                   mesh.positions(i, 0),
                   mesh.positions(i, 1),
                   mesh.positions(i, 2));
    for_each_column(fields, [&](const VertexField& field, Eigen::Index k) {
      text += ' ';
      append_value(text, field, field.values(i, k), "nan");
    });
    text += '\n';
  }
  for (int p = 0; p < mesh.polygon_count(); ++p) {
    const int begin = mesh.polygon_begin[idx(p)], end = mesh.polygon_begin[idx(p + 1)];
    text += fmt::format("{}", end - begin);
    for (int c = begin; c < end; ++c) text += fmt::format(" {}", mesh.corner_vertex[idx(c)]);
    text += '\n';
  }
  return text;
}

}  // namespace crosspatch
