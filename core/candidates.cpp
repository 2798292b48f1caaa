#include "core/candidates.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// The first target.size() source tips assigned, -1 for a tip left out.
struct Partial {
  std::vector<std::int8_t> target;
  int pairs = 0;
  double signature = 0;  ///< sum over the assigned tips
  double distance = 0;   ///< sum over pairs of assigned tips
  double cost = 0;
};

class Search {
 public:
  Search(const TipDescriptors& source, const TipDescriptors& target, const ProposalOptions& options)
      : source_(source),
        target_(target),
        options_(options),
        most_pairs_(std::min(source.count(), target.count())),
        reflected_(!options.source_partner.empty() && !options.target_partner.empty()),
        least_pairs_(reflected_
                         ? std::min(most_pairs_, options.least_pairs)
                         : std::max(std::min(most_pairs_, options.least_pairs), most_pairs_ - 1)) {
    signature_.resize(source.count(), target.count());
    for (int i = 0; i < source.count(); ++i)
      for (int j = 0; j < target.count(); ++j)
        signature_(i, j) = (source.signature.row(i) - target.signature.row(j)).cwiseAbs().mean();
  }

  std::vector<TipAssignment> run() {
    if (most_pairs_ == 0) return {};
    std::vector<Partial> layer(1), grown;
    for (int tip = 0; tip < source_.count(); ++tip) {
      grown.clear();
      for (const Partial& partial : layer) grow(partial, grown);
      if (tip + 1 < source_.count()) keep_best(grown, std::max(options_.beam, options_.keep));
      layer.swap(grown);
    }
    std::vector<TipAssignment> result;
    for (const Partial& partial : share_out(std::move(layer))) {
      TipAssignment assignment{{}, partial.cost};
      for (int i = 0; i < source_.count(); ++i)
        if (partial.target[idx(i)] >= 0) assignment.pairs.emplace_back(i, partial.target[idx(i)]);
      result.push_back(std::move(assignment));
    }
    return result;
  }

 private:
  void grow(const Partial& partial, std::vector<Partial>& out) const {
    const int tip = static_cast<int>(partial.target.size());
    const bool is_fixed = tip < options_.fixed;
    for (int j = is_fixed ? tip : options_.fixed; j < (is_fixed ? tip + 1 : target_.count()); ++j) {
      if (std::find(partial.target.begin(), partial.target.end(), j) != partial.target.end())
        continue;
      if (!is_fixed && !agrees(partial, tip, j)) continue;
      Partial next = partial;
      ++next.pairs;
      next.signature += signature_(tip, j);
      for (int i = 0; i < tip; ++i)
        if (partial.target[idx(i)] >= 0)
          next.distance +=
              discrepancy(source_.distance(i, tip), target_.distance(partial.target[idx(i)], j));
      next.target.push_back(static_cast<std::int8_t>(j));
      finish(std::move(next), out);
    }
    const int still_possible = partial.pairs + source_.count() - tip - 1;
    if (is_fixed || still_possible < least_pairs_ || !agrees(partial, tip, -1)) return;
    Partial next = partial;
    next.target.push_back(-1);
    finish(std::move(next), out);
  }

  /// Whether the reflections allow `tip` to go to j (-1: to be left out) after the ones before it.
  [[nodiscard]] bool agrees(const Partial& partial, int tip, int j) const {
    if (!reflected_) return true;
    const int partner = options_.source_partner[idx(tip)];
    if (partner < 0 || (j < 0 && partner == tip)) return true;
    const int image = j < 0 ? -1 : options_.target_partner[idx(j)];
    if (j >= 0 && image < 0) return true;
    if (j >= 0 && (partner == tip || image == j)) return partner == tip && image == j;
    if (partner > tip) return true;  // its partner will be asked
    const int there = partial.target[idx(partner)];
    if (there >= 0 && options_.target_partner[idx(there)] < 0) return true;
    return there == image;
  }

  void finish(Partial partial, std::vector<Partial>& out) const {
    // Tips left out beyond those that must be, since the other surface has fewer.
    const int skipped = std::max(
        0,
        static_cast<int>(partial.target.size()) - partial.pairs - (source_.count() - most_pairs_));
    const int n = partial.pairs;
    partial.cost = options_.skip_weight * skipped / most_pairs_;
    if (n > 0) partial.cost += options_.signature_weight * partial.signature / n;
    if (n > 1) partial.cost += options_.distance_weight * partial.distance / (0.5 * n * (n - 1));
    out.push_back(std::move(partial));
  }

  /// The best complete assignments of both classes, by rising cost.
  [[nodiscard]] std::vector<Partial> share_out(std::vector<Partial> all) const {
    const auto middle = std::partition(
        all.begin(), all.end(), [&](const Partial& p) { return p.pairs == most_pairs_; });
    std::vector<Partial> rest(middle, all.end());
    all.erase(middle, all.end());
    const int full_places =
        std::max(static_cast<int>(std::lround(options_.full_share * options_.keep)),
                 options_.keep - static_cast<int>(rest.size()));
    keep_best(all, full_places);
    keep_best(rest, options_.keep - static_cast<int>(all.size()));
    all.insert(all.end(), rest.begin(), rest.end());
    keep_best(all, options_.keep);
    return all;
  }

  static double discrepancy(double a, double b) {
    return a + b > 0 ? std::abs(a - b) / (a + b) : 0;
  }

  static void keep_best(std::vector<Partial>& partials, int count) {
    const auto cheaper = [](const Partial& a, const Partial& b) {
      return a.cost != b.cost ? a.cost < b.cost : a.target < b.target;
    };
    const auto kept = std::min(partials.size(), idx(count));
    const auto end = partials.begin() + static_cast<std::ptrdiff_t>(kept);
    std::partial_sort(partials.begin(), end, partials.end(), cheaper);
    partials.erase(end, partials.end());
  }

  const TipDescriptors& source_;
  const TipDescriptors& target_;
  const ProposalOptions& options_;
  int most_pairs_;
  bool reflected_;  ///< whether reflections have a say
  int least_pairs_;
  Eigen::MatrixXd signature_;  ///< source tips x target tips
};

}  // namespace

TipDescriptors tip_descriptors(const ShapeFeatures& features) {
  const auto n = static_cast<Eigen::Index>(features.tips.size());
  TipDescriptors result{Eigen::MatrixXd(n, features.wks.cols()), Eigen::MatrixXd(n, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const int v = features.tips[idx(i)].vertex;
    result.signature.row(i) = features.wks.row(v).array().log();
    result.distance.row(i) = features.tip_distances.row(v);
  }
  result.distance = (0.5 * (result.distance + result.distance.transpose())).eval();
  const double sum = result.distance.sum();
  if (sum > 0) result.distance *= static_cast<double>(n * (n - 1)) / sum;
  return result;
}

std::vector<TipAssignment> propose(const TipDescriptors& source,
                                   const TipDescriptors& target,
                                   const ProposalOptions& options) {
  assert(source.signature.cols() == target.signature.cols());
  assert(options.fixed <= std::min(source.count(), target.count()));
  assert(source.count() < 128 && target.count() < 128);
  return Search(source, target, options).run();
}

}  // namespace crosspatch
