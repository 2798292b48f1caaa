// Matches the pairs of a data set by the paper's method and by the default one, and prints CSV: a
// row per set, method and kind of node with the share of matches that lie near the truth.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <map>
#include <tuple>

#include "tools/benchmarks/truth.hpp"
#include "tools/pipeline.hpp"

namespace crosspatch {
namespace {

struct Arguments {
  std::string data = default_data_folder().string();
  std::vector<std::string> sets{"s07_fourleg", "tosca5k", "faust5k", "toscaNI5k"};
  std::vector<std::string> methods{"paper", "default"};
  int limit = 0;
  int threads = 1;
};

constexpr double kNear = 0.1, kFar = 0.25;  // of the square root of the target's area

/// Counts over the matches of one kind.
struct Tally {
  int matched = 0;
  int near = 0;        ///< within kNear of the truth
  int far = 0;         ///< within kFar
  int far_either = 0;  ///< within kFar of the truth or of the mirrored truth
  int pairs_with = 0;  ///< pairs in which the kind was matched at all
};

/// By set, method and kind; "all" stands for all kinds together.
using Table = std::map<std::tuple<std::string, std::string, std::string>, Tally>;

struct Counts {
  int pairs = 0;
  int failed = 0;
};

Result<Matching> matching_of(const DataPair& pair, const std::string& method) {
  Progress progress(true, kMapStages);
  PairFiles files;
  files.source = pair.source;
  files.target = pair.target;
  if (method == "default")
    return run_pair(files, progress).and_then([&](const PairRun& run) {
      return judged_matching(run, progress);
    });
  return read_pair(files, progress).and_then([&](const PairRun& run) {
    return paper_matching(run, progress);
  });
}

/// What came of one pair: errors against the truth and, where there is one, its mirror image.
struct Judged {
  Matching matching;
  std::vector<double> direct, mirrored;
};

Result<Judged> judge_pair(const DataPair& pair, const std::string& method) {
  Result<Matching> matching = matching_of(pair, method);
  if (!matching) return tl::unexpected(matching.error());
  const Result<InputMesh> source = read_input(pair.source), target = read_input(pair.target);
  if (!source) return tl::unexpected(source.error());
  if (!target) return tl::unexpected(target.error());
  const auto errors = [&](const std::string& path) {
    return read_truth(path, pair.truth_kind == "dense", source->prepared, target->prepared)
        .map([&](const Truth& truth) {
          return match_errors(*matching, truth, source->prepared.mesh, target->prepared.mesh);
        });
  };
  Result<std::vector<double>> direct = errors(pair.truth);
  if (!direct) return tl::unexpected(direct.error());
  Result<std::vector<double>> mirrored =
      pair.mirrored_truth.empty() ? direct : errors(pair.mirrored_truth);
  if (!mirrored) return tl::unexpected(mirrored.error());
  return Judged{std::move(*matching), std::move(*direct), std::move(*mirrored)};
}

void count(const Judged& judged, const std::string& set, const std::string& method, Table& table) {
  std::map<std::string, Tally> found;
  for (std::size_t i = 0; i < judged.matching.matches.size(); ++i)
    for (const std::string_view kind : {name(judged.matching.matches[i].kind), {"all"}}) {
      Tally& tally = found[std::string(kind)];
      const double direct = judged.direct[i], either = std::min(direct, judged.mirrored[i]);
      ++tally.matched;
      tally.near += direct <= kNear ? 1 : 0;
      tally.far += direct <= kFar ? 1 : 0;
      tally.far_either += either <= kFar ? 1 : 0;
    }
  for (const auto& [kind, tally] : found) {
    Tally& total = table[{set, method, kind}];
    total.matched += tally.matched;
    total.near += tally.near;
    total.far += tally.far;
    total.far_either += tally.far_either;
    ++total.pairs_with;
  }
}

void print_rows(const std::string& set,
                const std::string& method,
                const Counts& counts,
                const Table& table) {
  for (const char* kind : {"max", "saddle", "min", "all"}) {
    const auto found = table.find({set, method, kind});
    const Tally tally = found == table.end() ? Tally{} : found->second;
    const auto share = [&](int part) {
      return tally.matched > 0 ? fmt::format("{:.3f}", static_cast<double>(part) / tally.matched)
                               : "";
    };
    fmt::print("{},{},{},{},{},{},{:.2f},{},{},{}\n",
               set,
               method,
               kind,
               counts.pairs,
               counts.failed,
               tally.matched,
               static_cast<double>(tally.matched) / std::max(1, counts.pairs - counts.failed),
               share(tally.near),
               share(tally.far),
               share(tally.far_either));
  }
  std::fflush(stdout);
}

/// One line a pair on standard error, so that a bad one can be looked at.
void print_pair(const DataPair& pair, const std::string& method, const Result<Judged>& judged) {
  if (!judged) return fmt::print(stderr, "{} {}: {}\n", pair.id, method, judged.error().message);
  fmt::print(stderr, "{} {}:", pair.id, method);
  for (std::size_t i = 0; i < judged->direct.size(); ++i)
    fmt::print(stderr,
               " {}:{:.2f}{}",
               name(judged->matching.matches[i].kind),
               judged->direct[i],
               judged->direct[i] > kFar && judged->mirrored[i] <= kFar ? "m" : "");
  fmt::print(stderr, "\n");
}

int run(const Arguments& arguments) {
  const auto pairs = read_data_pairs(arguments.data);
  if (!pairs) return fmt::print(stderr, "{}\n", pairs.error().message), 3;
  fmt::print(
      "set,method,kind,pairs,failed,matched,matched_per_pair,within_10,within_25,"
      "within_25_of_either_side\n");
  for (const std::string& set : arguments.sets)
    for (const std::string& method : arguments.methods) {
      Table table;
      Counts counts;
      for (const DataPair& pair : pairs_of_set(*pairs, set, arguments.limit)) {
        if (pair.truth.empty()) continue;
        const Result<Judged> judged = judge_pair(pair, method);
        print_pair(pair, method, judged);
        ++counts.pairs;
        if (judged)
          count(*judged, set, method, table);
        else
          ++counts.failed;
      }
      print_rows(set, method, counts, table);
    }
  return 0;
}

}  // namespace
}  // namespace crosspatch

int main(int argc, char** argv) {
  crosspatch::Arguments arguments;
  CLI::App app("Shares of sparse matches near the truth; CSV on standard output");
  app.add_option("--data", arguments.data, "Folder with pairs.csv")->capture_default_str();
  app.add_option("--sets", arguments.sets, "Sets to run")->delimiter(',')->capture_default_str();
  app.add_option("--methods", arguments.methods, "paper, default")
      ->delimiter(',')
      ->check(CLI::IsMember({"paper", "default"}))
      ->capture_default_str();
  app.add_option("--limit", arguments.limit, "Pairs of a set at most, spread over it; 0 = all")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--threads", arguments.threads, "Threads to work with")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(arguments.threads));
  return crosspatch::run(arguments);
}
