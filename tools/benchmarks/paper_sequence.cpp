#include <fmt/format.h>

#include <algorithm>

#include "core/index.hpp"
#include "tools/benchmarks/deformations.hpp"
#include "tools/benchmarks/paper.hpp"

namespace crosspatch {
namespace {

constexpr int kSteps = 6;

Result<std::vector<SparseShape>> make_sequence(const SparseShape& null) {
  std::vector<SparseShape> sequence;
  for (int step = 0; step <= kSteps; ++step) {
    auto shape = make_sparse_shape(fmt::format("step {}", step),
                                   morph(null.mesh(), static_cast<double>(step) / kSteps));
    if (!shape) return tl::unexpected(shape.error());
    sequence.push_back(std::move(*shape));
  }
  return sequence;
}

/// Per step, the true assignments of the nodes of `null` that all steps have.
std::vector<std::vector<NodePair>> kept_nodes(const SparseShape& null,
                                              const std::vector<SparseShape>& sequence) {
  std::vector<std::vector<NodePair>> pairs(sequence.size());
  for (int i = 0; i < null.matching.graph.node_count(); ++i) {
    std::vector<NodePair> partners;
    for (const SparseShape& shape : sequence) partners.push_back({i, same_node(null, shape, i), 0});
    if (std::any_of(
            partners.begin(), partners.end(), [](const NodePair& p) { return p.target < 0; }))
      continue;
    for (size_t step = 0; step < sequence.size(); ++step) pairs[step].push_back(partners[step]);
  }
  return pairs;
}

/// The matrix M between `null` and `shape` over the given assignments, whose scores are filled in.
Eigen::MatrixXd true_matrix(const SparseShape& null,
                            const SparseShape& shape,
                            std::vector<NodePair> pairs,
                            const SpectralMatchingOptions& options) {
  const Eigen::MatrixXd H = node_scores(null.matching, shape.matching, options.signature);
  for (NodePair& pair : pairs) pair.score = H(pair.source, pair.target);
  return score_matrix(null.matching, shape.matching, pairs, options);
}

double mean_off_diagonal(const Eigen::MatrixXd& M) {
  const auto n = static_cast<double>(M.rows());
  return n > 1 ? (M.cwiseAbs().sum() - M.diagonal().cwiseAbs().sum()) / (n * (n - 1)) : 0;
}

/// Largest minus smallest value of every entry.
Eigen::MatrixXd range_of(const std::vector<Eigen::MatrixXd>& matrices) {
  Eigen::MatrixXd low = matrices.front(), high = matrices.front();
  for (const Eigen::MatrixXd& M : matrices) {
    low = low.cwiseMin(M);
    high = high.cwiseMax(M);
  }
  return high - low;
}

/// The matrices and their range side by side on one scale, a bright column between two.
Bitmap draw_strip(std::vector<Eigen::MatrixXd> matrices) {
  constexpr int kCell = 8;
  matrices.push_back(range_of(matrices));
  const Eigen::Index n = matrices.front().rows(),
                     count = static_cast<Eigen::Index>(matrices.size());
  double most = 0;
  for (const Eigen::MatrixXd& M : matrices) most = std::max(most, M.maxCoeff());
  Eigen::MatrixXd strip = Eigen::MatrixXd::Constant(n, count * (n + 1) - 1, most);
  for (Eigen::Index i = 0; i < count; ++i) strip.middleCols(i * (n + 1), n) = matrices[idx(i)];
  return draw_matrix(
      strip, kCell * static_cast<int>(strip.cols()), kCell * static_cast<int>(strip.rows()));
}

void print_row(const std::string& variant,
               size_t step,
               const SparseShape& shape,
               const JudgedMatching& judged,
               const Eigen::MatrixXd& M,
               const Eigen::MatrixXd& first) {
  fmt::print("{},{},{},{},{},{:.4f},{:.4f},{:.4f}\n",
             variant,
             step,
             shape.matching.graph.node_count(),
             M.rows(),
             columns(judged),
             mean_off_diagonal(M),
             mean_off_diagonal(M - first),
             (M - first).diagonal().cwiseAbs().mean());
}

}  // namespace

Status figure_11(const PaperArguments& arguments) {
  const auto null = read_sparse_shape(arguments.samples + "/lira.obj");
  if (!null) return tl::unexpected(null.error());
  const auto sequence = make_sequence(*null);
  if (!sequence) return tl::unexpected(sequence.error());
  const std::vector<std::vector<NodePair>> pairs = kept_nodes(*null, *sequence);
  const std::vector<Variant> variants{
      {"connectivity", {.order_correction = false}},
      {"connectivity_order", {}},
      {"geodesic", {.constraint = PairConstraint::kGeodesic, .order_correction = false}},
      {"geodesic_order", {.constraint = PairConstraint::kGeodesic}}};
  fmt::print(
      "variant,step,nodes,kept_nodes,matched,within_10,within_25,off_diagonal_mean,"
      "off_diagonal_change,diagonal_change\n");
  const Truth truth = identity_truth(null->mesh().vertex_count());
  PictureSheet sheet;
  for (const Variant& variant : variants) {
    std::vector<Eigen::MatrixXd> matrices;
    for (size_t step = 0; step < sequence->size(); ++step) {
      const SparseShape& shape = (*sequence)[step];
      const JudgedMatching judged = match_sparsely(*null, shape, truth, variant.options);
      matrices.push_back(true_matrix(*null, shape, pairs[step], variant.options));
      print_row(variant.name, step, shape, judged, matrices.back(), matrices.front());
      if (!arguments.output.empty())
        add_matching(sheet, fmt::format("{} {}", variant.name, step), *null, shape, judged);
    }
    const Eigen::MatrixXd range = range_of(matrices);
    fmt::print("{},range,,{},,,,,{:.4f},{:.4f}\n",
               variant.name,
               range.rows(),
               mean_off_diagonal(range),
               range.diagonal().mean());
    if (arguments.output.empty() || variant.options.order_correction) continue;  // the same M
    if (const Status written =
            write_picture(draw_strip(matrices),
                          fmt::format("{}/figure_11_{}.png", arguments.output, variant.name));
        !written)
      return written;
  }
  return finish_sheet(arguments, sheet, static_cast<int>(sequence->size()));
}

}  // namespace crosspatch
