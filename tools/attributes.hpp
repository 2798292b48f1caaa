#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

#include "tools/input.hpp"
#include "tools/output_files.hpp"
#include "transfer/carry_curves.hpp"
#include "transfer/vertex_fields.hpp"

namespace crosspatch {

/// What stands on the source and is to be carried, and where to.
struct AttributeFiles {
  std::string input;   ///< .csv or .ply: fields; .json: landmarks and curves
  std::string output;  ///< .csv or .ply of fields, .json or .ply of landmarks and curves
};

/// Pairs the inputs with the outputs that are asked for, in their order; without any, an output
/// lies beside `mesh_output` and has its name, an underscore and the input's name.
std::vector<AttributeFiles> attribute_files(const std::vector<std::string>& inputs,
                                            const std::vector<std::string>& outputs,
                                            const std::string& mesh_output);

/// What is wrong with a pair of names, or "".
std::string attribute_files_problem(const AttributeFiles& files);

/// What one input holds.
using Attributes = std::variant<std::vector<VertexField>, Drawing>;

/// Reads the inputs, for the source's file. kBadInput with the path.
Result<std::vector<Attributes>> read_attributes(const std::vector<AttributeFiles>& files,
                                                const InputMesh& source);

struct CarriedAttributes {
  std::vector<OutputFile> outputs;
  std::map<std::string, double> figures;
  std::string summary;  ///< what was carried
  std::string warning;  ///< what has no value or place on the target; empty if all has
};

/// Carries what was read over the map and writes it in the numbering of the target's file.
CarriedAttributes carry_attributes(const std::vector<AttributeFiles>& files,
                                   const std::vector<Attributes>& attributes,
                                   const InputMesh& source,
                                   const InputMesh& target,
                                   const SurfaceMap& map);

}  // namespace crosspatch
