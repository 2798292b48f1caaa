// The experiments of the paper, figure by figure: CSV on standard output and, with --output, a
// picture each. Source: Feng et al. 2013, Sec. 6.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include "core/geodesics.hpp"
#include "core/index.hpp"
#include "tools/benchmarks/deformations.hpp"
#include "tools/benchmarks/picture.hpp"
#include "tools/input.hpp"

namespace crosspatch {
namespace {

struct Arguments {
  int figure = 8;
  std::string data = default_data_folder().string();
  std::string samples = "samples";
  std::string output;  ///< folder for pictures; empty = none
  int limit = 4;
  int threads = 1;
};

/// Two surfaces to match, and what is known about them.
struct Couple {
  std::string label;
  std::string group;
  SparseShape source, target;
  Truth truth;  ///< without pairs: unknown
};

constexpr double kNear = 0.1, kFar = 0.25;

std::string share(const JudgedMatching& judged, double distance) {
  const double value = judged.share_within(distance);
  return std::isnan(value) ? "" : fmt::format("{:.3f}", value);
}

/// The columns that describe a matching: matched,within_10,within_25.
std::string columns(const JudgedMatching& judged) {
  return fmt::format(
      "{},{},{}", judged.matching.matches.size(), share(judged, kNear), share(judged, kFar));
}

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
Result<Couple> deformed_couple(const Arguments& arguments,
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
std::vector<DataPair> some_pairs(const Arguments& arguments, const std::vector<std::string>& sets) {
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

/// Writes the sheet of a figure, where pictures are wanted.
Status finish_sheet(const Arguments& arguments, const PictureSheet& sheet, int columns_wide) {
  if (arguments.output.empty()) return {};
  return write_sheet(
      sheet, columns_wide, fmt::format("{}/figure_{}.png", arguments.output, arguments.figure));
}

/// How a figure varies the matcher.
struct Variant {
  std::string name;
  SpectralMatchingOptions options;
};

/// Every couple by every variant: CSV rows "group,pair,variant,matched,within_10,within_25".
Status compare_variants(const Arguments& arguments,
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
    const Arguments& arguments, const std::vector<std::pair<Deformation, double>>& ways) {
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
Status figure_8(const Arguments& arguments) {
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
Status figure_9(const Arguments& arguments) {
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
Status figure_10(const Arguments& arguments) {
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

/// The node of `shape` of the kind of node `i` of `null` nearest to its place (vertex numbers are
/// shared), or -1 if none is within 0.1 sqrt(area).
int same_node(const SparseShape& null, const SparseShape& shape, int i) {
  const MorseNode& node = null.matching.graph.node(i);
  const Eigen::VectorXd distance = geodesic_distance_to_set(shape.mesh(), {node.vertex});
  int nearest = -1;
  double least = kNear * std::sqrt(total_area(shape.mesh()));
  for (int j = 0; j < shape.matching.graph.node_count(); ++j) {
    const MorseNode& other = shape.matching.graph.node(j);
    if (other.kind != node.kind || distance[other.vertex] > least) continue;
    least = distance[other.vertex];
    nearest = j;
  }
  return nearest;
}

/// The matrix M between `null` and `shape` over the given assignments, whose scores are filled in.
Eigen::MatrixXd true_matrix(const SparseShape& null,
                            const SparseShape& shape,
                            const std::vector<NodePair>& pairs,
                            const SpectralMatchingOptions& options) {
  const Eigen::MatrixXd H = node_scores(null.matching, shape.matching, options.signature);
  std::vector<NodePair> scored = pairs;
  for (NodePair& pair : scored) pair.score = H(pair.source, pair.target);
  return score_matrix(null.matching, shape.matching, scored, options);
}

double mean_off_diagonal(const Eigen::MatrixXd& M) {
  const double n = static_cast<double>(M.rows());
  return n > 1 ? (M.cwiseAbs().sum() - M.diagonal().cwiseAbs().sum()) / (n * (n - 1)) : 0;
}

/// Fig. 11: one shape against a sequence that departs from it, and what becomes of the matrix M.
/// The matrix is taken over the true partners of those nodes that all steps have.
Status figure_11(const Arguments& arguments) {
  constexpr int kSteps = 6;
  const auto null = read_sparse_shape(arguments.samples + "/lira.obj");
  if (!null) return tl::unexpected(null.error());
  std::vector<SparseShape> sequence;
  for (int step = 0; step <= kSteps; ++step) {
    auto shape = make_sparse_shape(fmt::format("step {}", step),
                                   morph(null->mesh(), static_cast<double>(step) / kSteps));
    if (!shape) return tl::unexpected(shape.error());
    sequence.push_back(std::move(*shape));
  }
  std::vector<std::vector<NodePair>> pairs(sequence.size());
  for (int i = 0; i < null->matching.graph.node_count(); ++i) {
    std::vector<NodePair> partners;
    for (const SparseShape& shape : sequence)
      partners.push_back({i, same_node(*null, shape, i), 0});
    if (std::all_of(
            partners.begin(), partners.end(), [](const NodePair& p) { return p.target >= 0; }))
      for (size_t step = 0; step < sequence.size(); ++step) pairs[step].push_back(partners[step]);
  }
  const std::vector<Variant> variants{
      {"connectivity", {.order_correction = false}},
      {"connectivity + order", {}},
      {"geodesic", {.constraint = PairConstraint::kGeodesic, .order_correction = false}},
      {"geodesic + order", {.constraint = PairConstraint::kGeodesic}}};
  fmt::print(
      "variant,step,nodes,kept_nodes,matched,within_10,within_25,off_diagonal_mean,"
      "off_diagonal_change,diagonal_change\n");
  const Truth truth = identity_truth(null->mesh().vertex_count());
  PictureSheet sheet;
  for (const Variant& variant : variants) {
    const Eigen::MatrixXd first = true_matrix(*null, sequence[0], pairs[0], variant.options);
    Eigen::MatrixXd low = first, high = first;
    for (size_t step = 0; step < sequence.size(); ++step) {
      const SparseShape& shape = sequence[step];
      const JudgedMatching judged = match_sparsely(*null, shape, truth, variant.options);
      const Eigen::MatrixXd M = true_matrix(*null, shape, pairs[step], variant.options);
      low = low.cwiseMin(M);
      high = high.cwiseMax(M);
      const Eigen::MatrixXd change = M - first;
      fmt::print("{},{},{},{},{},{:.4f},{:.4f},{:.4f}\n",
                 variant.name,
                 step,
                 shape.matching.graph.node_count(),
                 pairs[step].size(),
                 columns(judged),
                 mean_off_diagonal(M),
                 mean_off_diagonal(change),
                 change.diagonal().cwiseAbs().mean());
      if (arguments.output.empty()) continue;
      add_matching(sheet, fmt::format("{} {}", variant.name, step), *null, shape, judged);
      constexpr int kSide = 240;
      if (!variant.options.order_correction)
        if (const Status written = write_picture(
                draw_matrix(M, kSide, kSide),
                fmt::format("{}/figure_11_{}_{}.png", arguments.output, variant.name, step));
            !written)
          return written;
    }
    fmt::print("{},range,,{},,,,,{:.4f},{:.4f}\n",
               variant.name,
               pairs[0].size(),
               mean_off_diagonal(high - low),
               (high - low).diagonal().mean());
  }
  return finish_sheet(arguments, sheet, static_cast<int>(sequence.size()));
}

/// Fig. 12: the human models of SHREC'07.
Status figure_12(const Arguments& arguments) {
  Arguments all = arguments;
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
Status figure_13(const Arguments& arguments) {
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
std::vector<DataPair> pairs_by_genus(const Arguments& arguments,
                                     const std::vector<std::string>& sets,
                                     const std::function<bool(int, int)>& wanted) {
  Arguments all = arguments;
  all.limit = 0;
  std::vector<DataPair> chosen;
  for (const DataPair& pair : some_pairs(all, sets)) {
    const Result<InputMesh> a = read_input(pair.source), b = read_input(pair.target);
    if (a && b && wanted(genus(a->prepared.mesh), genus(b->prepared.mesh))) chosen.push_back(pair);
  }
  return chosen;
}

/// Fig. 14: surfaces of the same genus, not 0.
Status figure_14(const Arguments& arguments) {
  return compare_variants(arguments,
                          {{"epsilon=0.6", {}}, {"epsilon=0.2", {.epsilon = 0.2}}},
                          {},
                          pairs_by_genus(arguments,
                                         {"s07_cup", "s07_chair", "genus1", "genus3"},
                                         [](int a, int b) { return a == b && a > 0; }));
}

/// Fig. 1: surfaces of different genus.
Status figure_1(const Arguments& arguments) {
  return compare_variants(
      arguments,
      {{"epsilon=0.6", {}}, {"epsilon=0.2", {.epsilon = 0.2}}},
      {},
      pairs_by_genus(
          arguments, {"s07_cup", "s07_chair", "s07_human"}, [](int a, int b) { return a != b; }));
}

const std::map<int, Status (*)(const Arguments&)> kFigures{{1, figure_1},
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
  crosspatch::Arguments arguments;
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
