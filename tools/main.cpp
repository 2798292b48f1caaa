#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <thread>

#include "tools/commands.hpp"
#include "tools/output_files.hpp"

namespace crosspatch {
namespace {

/// One line on standard error, whatever the message holds.
int stop(ExitCode code, std::string message) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  fmt::print(stderr, "crosspatch: error: {}\n", message);
  return static_cast<int>(code);
}

int run_program(int argc, const char* const* argv) {
  const tl::expected<Command, CommandLineStop> command = parse_command_line(argc, argv);
  if (!command) {
    if (command.error().code != ExitCode::kDone)
      return stop(command.error().code, command.error().text);
    fmt::print("{}", command.error().text);
    return static_cast<int>(ExitCode::kDone);
  }
  if (const Status writable = check_output_paths(output_paths(*command)); !writable)
    return stop(ExitCode::kUsage, writable.error().message);
  const CommonArguments& common = common_arguments(*command);
  const auto machine = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(common.threads.value_or(machine)));
  const Result<ExitCode> result =
      std::visit([](const auto& arguments) { return run(arguments); }, *command);
  if (!result) return stop(exit_code(result.error().code), result.error().message);
  return static_cast<int>(*result);
}

}  // namespace
}  // namespace crosspatch

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed standard output is an error of writing, not a death
  try {
    return crosspatch::run_program(argc, argv);
  } catch (const std::bad_alloc&) {
    return crosspatch::stop(crosspatch::ExitCode::kInternal, "out of memory");
  } catch (const std::exception& error) {
    return crosspatch::stop(crosspatch::ExitCode::kInternal,
                            fmt::format("internal error: {}", error.what()));
  }
}
