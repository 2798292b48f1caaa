#pragma once

#include <string>
#include <vector>

#include "tools/command_line.hpp"

namespace crosspatch {

/// The files a command is asked to write.
std::vector<std::string> output_paths(const Command& command);

/// Runs a command and writes its outputs, all or none. kDone or kGateFailed; an error otherwise,
/// with nothing written.
Result<ExitCode> run(const InspectArguments& arguments);
Result<ExitCode> run(const MatchArguments& arguments);
Result<ExitCode> run(const MapArguments& arguments);
Result<ExitCode> run(const TransferArguments& arguments);
Result<ExitCode> run(const RenderArguments& arguments);
Result<ExitCode> run(const DoctorArguments& arguments);

}  // namespace crosspatch
