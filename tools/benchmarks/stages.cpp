// Maps pairs of meshes and prints CSV: a row per pair and number of threads, the medians of the
// runs in seconds per stage, and the most memory that the process has held.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>

#include "benchmark_commit.hpp"
#include "tools/benchmarks/timing.hpp"
#include "tools/pipeline.hpp"

namespace crosspatch {
namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::string landmarks;
  std::vector<int> threads{2};
  int runs = 3;
};

constexpr std::array kStages{
    "source", "target", "features", "embedding", "judging", "finals", "map"};

Status measure(const PairFiles& files, int threads, int runs) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
  std::array<std::vector<double>, kStages.size()> stages;
  std::vector<double> sums, cpu;
  std::array<int, 2> triangles{};
  for (int run = 0; run < runs; ++run) {
    const double begun = cpu_seconds();
    Progress progress(true, kMapStages);
    const Result<PairRun> pair = run_pair(files, progress);
    if (!pair) return tl::unexpected(pair.error());
    triangles = {pair->source.prepared.mesh.face_count(), pair->target.prepared.mesh.face_count()};
    cpu.push_back(cpu_seconds() - begun);
    sums.push_back(0);
    for (std::size_t i = 0; i < kStages.size(); ++i) {
      stages[i].push_back(0);
      for (const StageRecord& record : progress.records())
        if (record.name == kStages[i]) stages[i].back() += record.seconds;
      sums.back() += stages[i].back();
    }
  }
  fmt::print("{},{},{},{},{},{},{}",
             std::filesystem::path(files.source).filename().string(),
             std::filesystem::path(files.target).filename().string(),
             triangles[0],
             triangles[1],
             files.landmarks.empty() ? "none" : "given",
             kBenchmarkCommit,
             threads);
  for (const std::vector<double>& stage : stages) fmt::print(",{:.3f}", median(stage));
  fmt::print(",{:.3f},{:.3f},{:.0f}\n", median(sums), median(cpu), peak_memory_mib());
  return {};
}

Status run(const Arguments& arguments) {
  fmt::print("source,target,source_triangles,target_triangles,landmarks,commit,threads");
  for (const char* stage : kStages) fmt::print(",{}", stage);
  fmt::print(",sum,cpu,peak_mib\n");
  for (std::size_t i = 0; i + 1 < arguments.meshes.size(); i += 2)
    for (const int threads : arguments.threads) {
      PairFiles files;
      files.source = arguments.meshes[i];
      files.target = arguments.meshes[i + 1];
      files.landmarks = arguments.landmarks;
      if (Status s = measure(files, threads, arguments.runs); !s) return s;
    }
  return {};
}

}  // namespace
}  // namespace crosspatch

int main(int argc, char** argv) {
  using namespace crosspatch;
  Arguments arguments;
  CLI::App app("Seconds per stage of maps, as CSV");
  app.add_option("meshes", arguments.meshes, "Pairs of meshes: SOURCE TARGET SOURCE TARGET ...")
      ->required();
  app.add_option("--landmarks", arguments.landmarks, "Landmarks of a single pair");
  app.add_option("--threads", arguments.threads, "Threads, one row each")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--runs", arguments.runs, "Runs a row")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const bool even = arguments.meshes.size() % 2 == 0;
  if (!even || (!arguments.landmarks.empty() && arguments.meshes.size() != 2)) {
    fmt::print(stderr,
               "benchmark_stages: {} meshes, {}\n",
               arguments.meshes.size(),
               even ? "landmarks are of one pair" : "not pairs");
    return 2;
  }
  if (const Status s = run(arguments); !s) {
    fmt::print(stderr, "benchmark_stages: {}\n", s.error().message);
    return 1;
  }
  return 0;
}
