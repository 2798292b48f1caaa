#include "tools/landmarks.hpp"

#include <fmt/format.h>

#include <map>
#include <string>

#include "tools/text_lines.hpp"

namespace crosspatch {
namespace {

/// One column: its name, how many vertices there are, and the line that named each.
struct Column {
  const char* name;
  int vertices;
  std::map<int, int> line_of_vertex;

  Status take(int line, int vertex) {
    if (vertex < 0 || vertex >= vertices)
      return fail(
          ErrorCode::kBadInput,
          fmt::format("line {}: {} vertex {} is outside [0, {})", line, name, vertex, vertices));
    const auto [earlier, fresh] = line_of_vertex.try_emplace(vertex, line);
    if (!fresh)
      return fail(ErrorCode::kBadInput,
                  fmt::format("line {}: {} vertex {} is already used in line {}",
                              line,
                              name,
                              vertex,
                              earlier->second));
    return {};
  }
};

}  // namespace

Result<std::vector<FileLandmark>> parse_landmarks(std::string_view text,
                                                  int source_vertices,
                                                  int target_vertices) {
  Column source{"source", source_vertices, {}}, target{"target", target_vertices, {}};
  std::vector<FileLandmark> landmarks;
  for (const TextLine& line : text_lines(text)) {
    FileLandmark landmark;
    if (line.words.size() != 2 || !parse_number(line.words[0], landmark.source_vertex) ||
        !parse_number(line.words[1], landmark.target_vertex))
      return fail(
          ErrorCode::kBadInput,
          fmt::format("line {}: not of the form 'source_vertex target_vertex'", line.number));
    for (const Status& status : {source.take(line.number, landmark.source_vertex),
                                 target.take(line.number, landmark.target_vertex)})
      if (!status) return tl::unexpected(status.error());
    landmarks.push_back(landmark);
  }
  return landmarks;
}

}  // namespace crosspatch
