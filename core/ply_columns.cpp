#include "core/ply_columns.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "core/file_bytes.hpp"
#include "core/ply_body.hpp"

namespace crosspatch {
namespace {

/// The first value of a property, a list's others passed over; nothing where the body ends.
std::optional<double> take_property(PlyBody& body, const PlyProperty& property) {
  if (!property.is_list) return body.take(property.type);
  const std::optional<double> count = body.take(property.count_type);
  if (!count || !(*count >= 0) || *count > static_cast<double>(body.bytes_left()))
    return std::nullopt;
  for (double i = 0; i < *count; ++i)
    if (!body.take(property.type)) return std::nullopt;
  return count;
}

}  // namespace

Result<PlyVertexColumns> read_ply_columns(std::string_view bytes) {
  const Result<PlyHeader> header = read_ply_header(bytes);
  if (!header) return tl::unexpected(header.error());
  PlyBody body(*header);
  for (const PlyElement& element : header->elements) {
    PlyVertexColumns read{element.count, {}};
    const bool wanted = element.name == "vertex";
    std::vector<int> column;  // per property, or -1
    for (const PlyProperty& p : element.properties) {
      const bool kept = wanted && !p.is_list && ply_vertex_slot(p.name) == kIgnored;
      column.push_back(kept ? static_cast<int>(read.columns.size()) : -1);
      if (kept) read.columns.push_back({p.name, p.type, {}});
    }
    for (long long i = 0; i < element.count; ++i)
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const PlyProperty& p = element.properties[k];
        const std::optional<double> value = take_property(body, p);
        if (!value || (column[k] >= 0 && std::isinf(*value)))
          return fail(ErrorCode::kBadInput,
                      fmt::format("{} {} (counted from 0): {}: no finite number, or the file ends",
                                  in_quotes(element.name),
                                  i,
                                  in_quotes(p.name)));
        if (column[k] >= 0)
          read.columns[static_cast<std::size_t>(column[k])].values.push_back(*value);
      }
    if (wanted) return read;
  }
  return fail(ErrorCode::kBadInput, "has no element 'vertex'");
}

}  // namespace crosspatch
