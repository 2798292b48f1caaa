#pragma once

#include <vector>

#include "tools/command_line.hpp"
#include "tools/output_files.hpp"
#include "tools/pipeline.hpp"
#include "tools/report.hpp"

namespace crosspatch {

/// What the two inputs hold, source first.
std::vector<InputSummary> input_summaries(const PairFiles& files, const PairRun& run);

/// The report of a run over a pair that has a map: inputs, figures of the map, warnings, and the
/// exit code they lead to. Command, options and outputs are left to the caller.
RunReport pair_report(const PairArguments& arguments, const PairRun& run);

/// Writes `outputs` and, if asked for, the report that lists them; says the warnings.
Result<ExitCode> finish(std::vector<OutputFile> outputs,
                        RunReport report,
                        const CommonArguments& common,
                        const Progress& progress);

/// The same for a run over a pair that has a map, with the page that was asked for.
Result<ExitCode> finish(std::vector<OutputFile> outputs,
                        RunReport report,
                        const PairArguments& arguments,
                        const PairRun& run,
                        Progress& progress);

}  // namespace crosspatch
