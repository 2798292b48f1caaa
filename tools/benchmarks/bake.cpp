// Bakes the texture of a pair whose map is given and prints CSV: a row per setting, the medians of
// the runs in CPU seconds per stage, and the most memory that the process has held.
#include "transfer/bake.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "benchmark_commit.hpp"
#include "tools/benchmarks/timing.hpp"
#include "tools/pipeline.hpp"

namespace crosspatch {
namespace {

struct Arguments {
  PairFiles files;
  std::vector<int> sizes{4096};
  int runs = 3;
  int threads = 1;
};

Status measure(const Arguments& arguments, const PairRun& pair, int size) {
  std::vector<BakeSeconds> runs;
  for (int run = 0; run < arguments.runs; ++run) {
    const auto baked = bake_texture({pair.source.prepared, pair.source.soup},
                                    {pair.target.prepared, pair.target.soup},
                                    pair.matched.result.map,
                                    {.size = size});
    if (!baked) return tl::unexpected(baked.error());
    runs.push_back(baked->statistics.cpu_seconds);
  }
  const auto column = [&](double BakeSeconds::*stage) {
    std::vector<double> seconds;
    for (const BakeSeconds& run : runs) seconds.push_back(run.*stage);
    return median(seconds);
  };
  fmt::print("{},{},{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.0f}\n",
             std::filesystem::path(arguments.files.source).filename().string(),
             std::filesystem::path(arguments.files.target).filename().string(),
             pair.source.prepared.mesh.face_count(),
             pair.target.prepared.mesh.face_count(),
             size,
             kBenchmarkCommit,
             arguments.threads,
             column(&BakeSeconds::prepare),
             column(&BakeSeconds::decode),
             column(&BakeSeconds::raster),
             column(&BakeSeconds::gutter),
             column(&BakeSeconds::measure),
             column(&BakeSeconds::encode),
             peak_memory_mib());
  return {};
}

Status run(const Arguments& arguments) {
  Progress progress(true, kMapStages);
  const Result<PairRun> pair = run_pair(arguments.files, progress);
  if (!pair) return tl::unexpected(pair.error());
  fmt::print(
      "source,target,source_triangles,target_triangles,size,commit,threads,prepare,decode,raster,"
      "gutter,measure,encode,peak_mib\n");
  for (const int size : arguments.sizes)
    if (Status s = measure(arguments, *pair, size); !s) return s;
  return {};
}

}  // namespace
}  // namespace crosspatch

int main(int argc, char** argv) {
  using namespace crosspatch;
  Arguments arguments;
  CLI::App app("CPU seconds and memory of a bake whose map is given, as CSV");
  app.add_option("source", arguments.files.source, "Mesh with a texture")->required();
  app.add_option("target", arguments.files.target, "Mesh to bake on")->required();
  app.add_option("--map", arguments.files.map, "The map, an overlay of the two")->required();
  app.add_option("--texture", arguments.files.texture, "Another texture for the source");
  app.add_option("--size", arguments.sizes, "Texels a side")->capture_default_str();
  app.add_option("--runs", arguments.runs, "Runs a row")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--threads", arguments.threads, "Threads")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(arguments.threads));
  if (const Status s = run(arguments); !s) {
    fmt::print(stderr, "benchmark_bake: {}\n", s.error().message);
    return 1;
  }
  return 0;
}
