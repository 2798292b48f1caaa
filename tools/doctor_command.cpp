// crosspatch doctor: what the program is made of, and what it may ask of this machine.
#include <fmt/format.h>
#include <unistd.h>

#include <thread>

#include "core/file_bytes.hpp"
#include "tools/commands.hpp"
#include "tools/version.hpp"
#include "tools/viewer.hpp"
#include "transfer/bake.hpp"

namespace crosspatch {
namespace {

double memory_gib() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(sysconf(_SC_PAGE_SIZE)) / (1 << 30);
}

}  // namespace

Result<ExitCode> run(const DoctorArguments&) {
  fmt::print("crosspatch {} ({})\n\nlibraries when it was built\n", kVersion, kCompiler);
  for (const LibraryVersion& library : kLibraries)
    fmt::print("  {:<16} {}\n", library.name, *library.version == 0 ? "-" : library.version);
  fmt::print("\nthis machine\n  {:<16} {}\n  {:<16} {:.1f} GiB\n",
             "threads",
             std::thread::hardware_concurrency(),
             "memory",
             memory_gib());
  const ReadLimits limits;
  fmt::print("\nlimits\n");
  fmt::print("  {:<16} {} GiB\n", "mesh file", limits.max_file_bytes >> 30);
  fmt::print("  {:<16} {} million\n", "triangles", limits.max_triangles / 1'000'000);
  fmt::print(
      "  {:<16} {} x {} texels\n", "images read", limits.max_image_side, limits.max_image_side);
  fmt::print("  {:<16} {} x {} texels\n", "images baked", kLargestBakeSize, kLargestBakeSize);
  fmt::print("  {:<16} connected; handles and holes that only one has end the map\n", "surfaces");
  fmt::print("\nreports (--report): {}\n",
             viewer_script().empty()
                 ? "not in this build: run tools/install_dependencies.sh build, then configure anew"
                 : "available");
  return ExitCode::kDone;
}

}  // namespace crosspatch
