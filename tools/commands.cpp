#include "tools/commands.hpp"

#include "tools/attributes.hpp"

namespace crosspatch {
namespace {

std::vector<std::string> files(const InspectArguments& arguments) {
  return {arguments.common.json};
}
std::vector<std::string> files(const MatchArguments& arguments) {
  return {arguments.output, arguments.pair.report, arguments.pair.common.json};
}
std::vector<std::string> files(const MapArguments& arguments) {
  return {arguments.output,
          arguments.inverse,
          arguments.overlay,
          arguments.pair.report,
          arguments.pair.common.json};
}
std::vector<std::string> files(const TransferArguments& arguments) {
  std::vector<std::string> paths{
      arguments.output, arguments.pair.report, arguments.pair.common.json};
  for (const AttributeFiles& attributes :
       attribute_files(arguments.attributes, arguments.attributes_output, arguments.output))
    paths.push_back(attributes.output);
  return paths;
}
std::vector<std::string> files(const RenderArguments& arguments) {
  return {arguments.output, arguments.common.json};
}
std::vector<std::string> files(const DoctorArguments&) {
  return {};
}

}  // namespace

std::vector<std::string> output_paths(const Command& command) {
  std::vector<std::string> paths =
      std::visit([](const auto& arguments) { return files(arguments); }, command);
  std::erase(paths, "");
  return paths;
}

}  // namespace crosspatch
