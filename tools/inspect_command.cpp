// crosspatch inspect: mesh file -> soup -> mesh -> summary
#include <fmt/format.h>

#include "tools/commands.hpp"
#include "tools/input.hpp"
#include "tools/output_files.hpp"
#include "tools/report.hpp"

namespace crosspatch {

Result<ExitCode> run(const InspectArguments& arguments) {
  Progress progress(arguments.common.quiet, 1);
  progress.begin("read");
  const Result<InputMesh> input = read_input(arguments.mesh);
  if (!input) return tl::unexpected(input.error());
  const InputSummary summary = summarize("mesh", arguments.mesh, input->soup, input->prepared);
  progress.end(fmt::format("{} triangles, {} repairs",
                           input->prepared.mesh.face_count(),
                           input->prepared.repairs.size()));
  const std::string& json = arguments.common.json;
  const RunReport report{.command = "inspect", .inputs = {summary}, .stages = progress.records()};
  std::vector<OutputFile> outputs;
  if (json != "-") outputs.push_back({"-", summary_text(summary)});
  if (!json.empty()) outputs.push_back({json, report_json(report)});
  if (const Status written = write_output_files(outputs); !written)
    return tl::unexpected(written.error());
  return ExitCode::kDone;
}

}  // namespace crosspatch
