#include "tools/attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "tools/drawing_text.hpp"
#include "tools/field_text.hpp"

namespace crosspatch {
namespace {

std::string extension(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

Result<Attributes> parse(const std::string& path,
                         const std::string& text,
                         const InputMesh& source) {
  const int vertices = static_cast<int>(source.soup.positions.rows());
  const auto wrap = [](auto parsed) -> Result<Attributes> {
    if (!parsed) return tl::unexpected(parsed.error());
    return Attributes(std::move(*parsed));
  };
  if (extension(path) == ".json") return wrap(parse_drawing(text, source.prepared));
  if (extension(path) == ".ply") return wrap(parse_fields_ply(text, vertices));
  return wrap(parse_fields_csv(text, vertices));
}

/// What was carried and what was not, over all inputs.
struct Sum {
  int fields = 0, unmapped_vertices = 0;
  int landmarks = 0, unmapped_landmarks = 0;
  int curves = 0, gaps = 0, paths = 0;
};

std::string carry(const std::vector<VertexField>& fields,
                  const std::string& output,
                  const InputMesh& source,
                  const InputMesh& target,
                  const SurfaceMap& map,
                  Sum& sum) {
  const CarriedFields carried =
      carry_fields({source.prepared, source.soup}, {target.prepared, target.soup}, map, fields);
  sum.fields += static_cast<int>(fields.size());
  sum.unmapped_vertices = carried.unmapped_vertices;  // the same for all fields
  return extension(output) == ".ply" ? fields_ply(carried.fields, target.soup)
                                     : fields_csv(carried.fields);
}

std::string carry(const Drawing& drawing,
                  const std::string& output,
                  const InputMesh& source,
                  const InputMesh& target,
                  const SurfaceMap& map,
                  Sum& sum) {
  const CarriedDrawing carried =
      carry_drawing(drawing, source.prepared.mesh, target.prepared.mesh, map);
  sum.landmarks += static_cast<int>(drawing.landmarks.size());
  sum.unmapped_landmarks += carried.unmapped_landmarks;
  sum.curves += static_cast<int>(drawing.curves.size());
  sum.gaps += carried.gaps;
  sum.paths += carried.paths;
  return extension(output) == ".ply" ? drawing_ply(carried.drawing, target.prepared)
                                     : drawing_json(carried.drawing, target.prepared);
}

std::string warning(const Sum& sum, const InputMesh& target) {
  std::string text;
  const auto add = [&](const std::string& part) {
    if (!text.empty()) text += ", ";
    text += part;
  };
  if (sum.unmapped_vertices > 0)
    add(fmt::format("{} of the target's {} vertices have no value",
                    sum.unmapped_vertices,
                    target.soup.positions.rows()));
  if (sum.unmapped_landmarks > 0)
    add(fmt::format("{} of {} landmarks have no place", sum.unmapped_landmarks, sum.landmarks));
  if (sum.gaps > 0) add(fmt::format("curves have {} gaps", sum.gaps));
  return text.empty() ? text : "attributes: nothing is mapped there: " + text;
}

}  // namespace

std::vector<AttributeFiles> attribute_files(const std::vector<std::string>& inputs,
                                            const std::vector<std::string>& outputs,
                                            const std::string& mesh_output) {
  std::vector<AttributeFiles> files;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (i < outputs.size()) {
      files.push_back({inputs[i], outputs[i]});
      continue;
    }
    const std::filesystem::path beside(mesh_output);
    const std::string name =
        beside.stem().string() + "_" + std::filesystem::path(inputs[i]).filename().string();
    files.push_back({inputs[i], (beside.parent_path() / name).string()});
  }
  return files;
}

std::string attribute_files_problem(const AttributeFiles& files) {
  const std::string in = extension(files.input), out = extension(files.output);
  if (in != ".csv" && in != ".ply" && in != ".json")
    return fmt::format("--attributes: '{}' is no .csv, .ply or .json", files.input);
  if (in == ".json" && out != ".json" && out != ".ply")
    return fmt::format(
        "--attributes-output: '{}' is no .json or .ply, as landmarks and curves need",
        files.output);
  if (in != ".json" && out != ".csv" && out != ".ply")
    return fmt::format("--attributes-output: '{}' is no .csv or .ply, as fields need",
                       files.output);
  return "";
}

Result<std::vector<Attributes>> read_attributes(const std::vector<AttributeFiles>& files,
                                                const InputMesh& source) {
  std::vector<Attributes> attributes;
  for (const AttributeFiles& file : files) {
    const Result<std::string> text = read_input_text(file.input);
    if (!text) return tl::unexpected(text.error());
    Result<Attributes> parsed = parse(file.input, *text, source);
    if (!parsed) return tl::unexpected(with_path(file.input, parsed.error()));
    attributes.push_back(std::move(*parsed));
  }
  return attributes;
}

CarriedAttributes carry_attributes(const std::vector<AttributeFiles>& files,
                                   const std::vector<Attributes>& attributes,
                                   const InputMesh& source,
                                   const InputMesh& target,
                                   const SurfaceMap& map) {
  CarriedAttributes carried;
  Sum sum;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& output = files[i].output;
    const auto visit = [&](const auto& a) { return carry(a, output, source, target, map, sum); };
    carried.outputs.push_back({output, std::visit(visit, attributes[i])});
  }
  carried.figures = {{"attribute_fields", sum.fields},
                     {"attribute_unmapped_vertices", sum.unmapped_vertices},
                     {"attribute_landmarks", sum.landmarks},
                     {"attribute_unmapped_landmarks", sum.unmapped_landmarks},
                     {"attribute_curves", sum.curves},
                     {"attribute_curve_gaps", sum.gaps},
                     {"attribute_curve_paths", sum.paths}};
  carried.summary =
      fmt::format("{} fields, {} landmarks, {} curves", sum.fields, sum.landmarks, sum.curves);
  carried.warning = warning(sum, target);
  return carried;
}

}  // namespace crosspatch
