// The experiments of the paper, figure by figure: CSV on standard output and, with --output, a
// picture each. Source: Feng et al. 2013, Sec. 6.
#include "tools/benchmarks/paper.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <map>

#include "tools/benchmarks/deformations.hpp"
#include "tools/input.hpp"

namespace crosspatch {
namespace {

/// Two surfaces to match, and what is known about them.
struct Couple {
  std::string label;
  std::string group;
  SparseShape source, target;
  Truth truth;  ///< without pairs: unknown
};

Result<Couple> read_couple(const DataPair& pair) {
  return read_sparse_shape(pair.source).and_then([&](SparseShape source) -> Result<Couple> {
    return read_sparse_shape(pair.target).and_then([&](SparseShape target) -> Result<Couple> {
      Couple couple{pair.id, pair.set, std::move(source), std::move(target), {}};
      if (pair.truth.empty() || pair.truth_kind == "published-map") return couple;
      auto truth = read_truth(
          pair.truth, pair.truth_kind == "dense", couple.source.prepared, couple.target.prepared);
      if (!truth) return tl::unexpected(truth.error());
      couple.truth = std::move(*truth);
      return couple;
    });
  });
}

/// The sample creature and the same deformed: the one couple that needs no data set.
Result<Couple> deformed_couple(const PaperArguments& arguments,
                               Deformation deformation,
                               double strength) {
  return read_sparse_shape(arguments.samples + "/lira.obj")
      .and_then([&](SparseShape source) -> Result<Couple> {
        const std::string label = fmt::format("lira {} {}", name(deformation), strength);
        auto target = make_sparse_shape(label, deform(source.mesh(), deformation, strength));
        if (!target) return tl::unexpected(target.error());
        const int vertices = source.mesh().vertex_count();
        return Couple{
            label, "sample", std::move(source), std::move(*target), identity_truth(vertices)};
      });
}

/// Pairs of the data set, a few of each set; none where there is no data set.
std::vector<DataPair> some_pairs(const PaperArguments& arguments,
                                 const std::vector<std::string>& sets) {
  std::vector<DataPair> chosen;
  const auto pairs = read_data_pairs(arguments.data);
  if (!pairs) {
    fmt::print(stderr, "without the data set: {}\n", pairs.error().message);
    return chosen;
  }
  for (const std::string& set : sets)
    for (const DataPair& pair : pairs_of_set(*pairs, set, arguments.limit)) chosen.push_back(pair);
  return chosen;
}

/// Calls `visit` with every couple that can be made and says why another cannot.
Status for_each_couple(const std::vector<DataPair>& pairs,
                       const std::function<void(const Couple&)>& visit) {
  for (const DataPair& pair : pairs) {
    const Result<Couple> couple = read_couple(pair);
    if (!couple) return tl::unexpected(couple.error());
    visit(*couple);
  }
  return {};
}

/// Every couple by every variant: CSV rows "group,pair,variant,matched,within_10,within_25".
Status compare_variants(const PaperArguments& arguments,
                        const std::vector<Variant>& variants,
                        const std::vector<Couple>& made,
                        const std::vector<DataPair>& pairs) {
  fmt::print("group,pair,variant,matched,within_10,within_25\n");
  PictureSheet sheet;
  const auto visit = [&](const Couple& couple) {
    for (const Variant& variant : variants) {
      const JudgedMatching judged =
          match_sparsely(couple.source, couple.target, couple.truth, variant.options);
      fmt::print("{},{},{},{}\n", couple.group, couple.label, variant.name, columns(judged));
      if (!arguments.output.empty())
        add_matching(
            sheet, couple.label + " " + variant.name, couple.source, couple.target, judged);
    }
    std::fflush(stdout);
  };
  for (const Couple& couple : made) visit(couple);
  if (const Status done = for_each_couple(pairs, visit); !done) return done;
  constexpr int kMostColumns = 4;
  const int wide = static_cast<int>(variants.size());
  return finish_sheet(arguments, sheet, wide > kMostColumns ? 3 : wide);
}

/// The sample deformed in each of the given ways.
Result<std::vector<Couple>> deformed_couples(
    const PaperArguments& arguments, const std::vector<std::pair<Deformation, double>>& ways) {
  std::vector<Couple> couples;
  for (const auto& [deformation, strength] : ways) {
    Result<Couple> couple = deformed_couple(arguments, deformation, strength);
    if (!couple) return tl::unexpected(couple.error());
    couples.push_back(std::move(*couple));
  }
  return couples;
}

const std::vector<std::string> kFallingIsometry{"faust5k", "tosca5k", "s07_fourleg", "toscaNI5k"};

/// Fig. 8: the balance alpha of Eq. (3).
Status figure_8(const PaperArguments& arguments) {
  std::vector<Variant> variants;
  for (const double alpha : {0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.999})
    variants.push_back({fmt::format("alpha={}", alpha), {.alpha = alpha}});
  variants.push_back({"alpha=1", {.method = MatchMethod::kHungarian}});
  return deformed_couples(arguments, {{Deformation::kLocalScale, 2}})
      .and_then([&](const auto& made) {
        return compare_variants(arguments, variants, made, some_pairs(arguments, kFallingIsometry));
      });
}

/// Fig. 9: the heat kernel signature alone and with the graph; the auto diffusion function beside.
Status figure_9(const PaperArguments& arguments) {
  const std::vector<Variant> variants{
      {"ADF alone", {.method = MatchMethod::kHungarian}},
      {"ADF + graph", {}},
      {"HKS alone", {.method = MatchMethod::kHungarian, .signature = NodeSignature::kHeatKernel}},
      {"HKS + graph", {.signature = NodeSignature::kHeatKernel}}};
  return deformed_couples(arguments, {{Deformation::kLocalScale, 2}})
      .and_then([&](const auto& made) {
        return compare_variants(arguments, variants, made, some_pairs(arguments, kFallingIsometry));
      });
}

/// Fig. 10: arcs against geodesic and diffusion distances, on pairs of falling isometry.
Status figure_10(const PaperArguments& arguments) {
  const std::vector<Variant> variants{{"geodesic", {.constraint = PairConstraint::kGeodesic}},
                                      {"diffusion", {.constraint = PairConstraint::kDiffusion}},
                                      {"connectivity", {}}};
  return deformed_couples(
             arguments,
             {{Deformation::kBend, 2}, {Deformation::kLocalScale, 2}, {Deformation::kAffine, 4}})
      .and_then([&](const auto& made) {
        return compare_variants(arguments, variants, made, some_pairs(arguments, kFallingIsometry));
      });
}

/// Fig. 12: the human models of SHREC'07.
Status figure_12(const PaperArguments& arguments) {
  PaperArguments all = arguments;
  all.limit = 0;
  std::vector<DataPair> pairs;
  for (const DataPair& pair : some_pairs(all, {"s07_human"}))
    if (pair.id != "s07_human_1_5") pairs.push_back(pair);  // of different genus: Fig. 1
  return compare_variants(arguments,
                          {{"epsilon=0.6", {}},
                           {"epsilon=0.2", {.epsilon = 0.2}},
                           {"geodesic", {.constraint = PairConstraint::kGeodesic}}},
                          {},
                          pairs);
}

/// Fig. 13: a null shape and what affine and other transformations make of it.
Status figure_13(const PaperArguments& arguments) {
  std::vector<SparseShape> nulls;
  std::vector<std::string> files{arguments.samples + "/lira.obj"};
  for (const DataPair& pair : some_pairs(arguments, {"faust5k"}))
    if (files.size() < 2) files.push_back(pair.source);
  fmt::print(
      "null,transformation,strength,maxima,saddles,minima,found_again,matched,within_10,"
      "within_25\n");
  PictureSheet sheet;
  for (const std::string& file : files) {
    const auto null = read_sparse_shape(file);
    if (!null) return tl::unexpected(null.error());
    const Truth truth = identity_truth(null->mesh().vertex_count());
    for (const Deformation deformation : kDeformations)
      for (int strength = 1; strength <= 5; ++strength) {
        const std::string label = fmt::format("{} {}", name(deformation), strength);
        const auto shape = make_sparse_shape(label, deform(null->mesh(), deformation, strength));
        if (!shape) return tl::unexpected(shape.error());
        const MorseSmaleComplex& complex = shape->matching.graph.complex;
        const int nodes = null->matching.graph.node_count();
        int again = 0;
        for (int i = 0; i < nodes; ++i) again += same_node(*null, *shape, i) >= 0 ? 1 : 0;
        const JudgedMatching judged = match_sparsely(*null, *shape, truth, {});
        fmt::print("{},{},{},{},{},{},{:.3f},{}\n",
                   null->label,
                   name(deformation),
                   strength,
                   complex.count(NodeKind::kMaximum),
                   complex.count(NodeKind::kSaddle),
                   complex.count(NodeKind::kMinimum),
                   static_cast<double>(again) / nodes,
                   columns(judged));
        std::fflush(stdout);
        if (!arguments.output.empty()) add_matching(sheet, label, *null, *shape, judged);
      }
  }
  constexpr int kStrengths = 5;
  return finish_sheet(arguments, sheet, kStrengths);
}

/// The pairs of the sets for which the genus is, or is not, that of both surfaces.
std::vector<DataPair> pairs_by_genus(const PaperArguments& arguments,
                                     const std::vector<std::string>& sets,
                                     const std::function<bool(int, int)>& wanted) {
  PaperArguments all = arguments;
  all.limit = 0;
  std::vector<DataPair> chosen;
  for (const DataPair& pair : some_pairs(all, sets)) {
    const Result<InputMesh> a = read_input(pair.source), b = read_input(pair.target);
    if (a && b && wanted(genus(a->prepared.mesh), genus(b->prepared.mesh))) chosen.push_back(pair);
  }
  return chosen;
}

/// Fig. 14: surfaces of the same genus, not 0.
Status figure_14(const PaperArguments& arguments) {
  return compare_variants(arguments,
                          {{"epsilon=0.6", {}}, {"epsilon=0.2", {.epsilon = 0.2}}},
                          {},
                          pairs_by_genus(arguments,
                                         {"s07_cup", "s07_chair", "genus1", "genus3"},
                                         [](int a, int b) { return a == b && a > 0; }));
}

/// Fig. 1: surfaces of different genus.
Status figure_1(const PaperArguments& arguments) {
  return compare_variants(
      arguments,
      {{"epsilon=0.6", {}}, {"epsilon=0.2", {.epsilon = 0.2}}},
      {},
      pairs_by_genus(
          arguments, {"s07_cup", "s07_chair", "s07_human"}, [](int a, int b) { return a != b; }));
}

const std::map<int, Status (*)(const PaperArguments&)> kFigures{{1, figure_1},
                                                                {8, figure_8},
                                                                {9, figure_9},
                                                                {10, figure_10},
                                                                {11, figure_11},
                                                                {12, figure_12},
                                                                {13, figure_13},
                                                                {14, figure_14}};

}  // namespace
}  // namespace crosspatch

int main(int argc, char** argv) {
  crosspatch::PaperArguments arguments;
  CLI::App app("The paper's experiments; CSV on standard output");
  app.add_option("--figure", arguments.figure, "1, 8, 9, 10, 11, 12, 13 or 14")
      ->required()
      ->check(CLI::IsMember({1, 8, 9, 10, 11, 12, 13, 14}));
  app.add_option("--data", arguments.data, "Folder with pairs.csv")->capture_default_str();
  app.add_option("--samples", arguments.samples, "Folder with lira.obj")->capture_default_str();
  app.add_option("--output", arguments.output, "Folder for pictures")
      ->check(CLI::ExistingDirectory);
  app.add_option("--limit", arguments.limit, "Pairs of a set at most; 0 = all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--threads", arguments.threads, "Threads to work with")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(arguments.threads));
  const crosspatch::Status done = crosspatch::kFigures.at(arguments.figure)(arguments);
  if (!done) fmt::print(stderr, "benchmark_paper: {}\n", done.error().message);
  return done ? 0 : 3;
}
