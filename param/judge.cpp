#include "param/judge.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

namespace crosspatch {
namespace {

using std::size_t;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Discs by the chain they are cut along; filled for many chains at once.
class DiscCache {
 public:
  explicit DiscCache(const Shape& shape) : shape_(shape) {}

  void want(const std::vector<int>& chain) { discs_.try_emplace(chain); }

  void cut() {
    std::vector<std::map<std::vector<int>, std::optional<ChainDisc>>::iterator> missing;
    for (auto it = discs_.begin(); it != discs_.end(); ++it)
      if (!it->second && tried_.insert({it->first, true}).second) missing.push_back(it);
    tbb::parallel_for(size_t{0}, missing.size(), [&](size_t i) {
      if (auto disc = cut_along_chain(shape_.coarse.mesh, missing[i]->first))
        missing[i]->second = std::move(*disc);
    });
  }

  [[nodiscard]] const ChainDisc* find(const std::vector<int>& chain) const {
    const auto it = discs_.find(chain);
    return it != discs_.end() && it->second ? &*it->second : nullptr;
  }

 private:
  const Shape& shape_;
  std::map<std::vector<int>, std::optional<ChainDisc>> discs_;
  std::map<std::vector<int>, bool> tried_;
};

struct Trial {
  size_t candidate;
  std::vector<int> source_chain, target_chain;
  double distortion = kInfinity;
};

/// The trials of the candidates, evaluated.
std::vector<Trial> run_trials(const ChainPlanner& planner,
                              const std::vector<Candidate>& candidates,
                              int chains,
                              DiscCache& source,
                              DiscCache& target) {
  std::vector<Trial> trials;
  for (size_t c = 0; c < candidates.size(); ++c)
    for (auto& [a, b] : planner.chains(candidates[c].landmarks, chains)) {
      source.want(a);
      target.want(b);
      trials.push_back({c, std::move(a), std::move(b)});
    }
  source.cut();
  target.cut();
  tbb::parallel_for(size_t{0}, trials.size(), [&](size_t i) {
    const ChainDisc *a = source.find(trials[i].source_chain),
                    *b = target.find(trials[i].target_chain);
    if (a != nullptr && b != nullptr) trials[i].distortion = disc_distortion(*a, *b);
  });
  return trials;
}

/// Initial maps of a mirrored candidate that go to the finals: as many as leaders mostly have.
constexpr size_t kMirroredChains = 2;

/// Moves the mirrored candidates of the first `leaders` in the order to the end of the first
/// `finalists`, where they are not among them. Returns how many. Of several that exchange as many
/// pairs it is the first that was given: the best proposal exchanges what is alike.
size_t append_mirrored(const std::vector<Candidate>& candidates,
                       std::vector<size_t>& order,
                       size_t finalists,
                       int leaders) {
  size_t end = finalists;
  for (size_t leader = 0; leader < std::min(finalists, static_cast<size_t>(leaders)); ++leader) {
    int most = 0;
    size_t mirrored = 0;
    for (size_t c = 0; c < candidates.size(); ++c)
      if (const int n = exchanged_pairs(candidates[order[leader]], candidates[c]); n > most) {
        most = n;
        mirrored = c;
      }
    const auto place = std::find(order.begin(), order.end(), mirrored);
    const auto next = order.begin() + static_cast<std::ptrdiff_t>(end);
    if (most == 0 || place < next) continue;
    std::rotate(next, place, place + 1);
    ++end;
  }
  return end - finalists;
}

}  // namespace

int exchanged_pairs(const Candidate& a, const Candidate& b) {
  if (a.landmarks.size() != b.landmarks.size()) return 0;
  std::map<int, int> target_of, source_of, other_target_of;
  for (const Landmark& l : a.landmarks) {
    target_of[l.source_vertex] = l.target_vertex;
    source_of[l.target_vertex] = l.source_vertex;
  }
  for (const Landmark& l : b.landmarks) other_target_of[l.source_vertex] = l.target_vertex;
  int moved = 0;
  for (const auto& [source, target] : target_of) {
    const auto other = other_target_of.find(source);
    if (other == other_target_of.end()) return 0;
    if (other->second == target) continue;
    const auto partner = source_of.find(other->second);
    if (partner == source_of.end()) return 0;
    const auto back = other_target_of.find(partner->second);
    if (back == other_target_of.end() || back->second != target) return 0;
    ++moved;
  }
  return moved / 2;
}

Result<Judgement> judge(const Shape& source,
                        const Shape& target,
                        std::vector<Candidate> candidates,
                        const JudgeOptions& options) {
  const ChainPlanner planner(source, target);
  DiscCache source_discs(source), target_discs(target);
  std::vector<std::vector<Trial>> trials(candidates.size());  // by distortion
  std::vector<size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto distortion = [&](size_t c) {
    return trials[c].empty() ? kInfinity : trials[c][0].distortion + candidates[c].prior;
  };
  // Tries the candidates from place `first` to before `last` of the order and sorts them.
  const auto evaluate = [&](size_t first, size_t last, int chains) {
    std::vector<Candidate> tried;
    for (size_t i = first; i < last; ++i) tried.push_back(candidates[order[i]]);
    for (size_t i = first; i < last; ++i) trials[order[i]].clear();
    for (Trial& t : run_trials(planner, tried, chains, source_discs, target_discs))
      if (t.distortion < kInfinity) trials[order[first + t.candidate]].push_back(std::move(t));
    for (size_t i = first; i < last; ++i)
      std::stable_sort(trials[order[i]].begin(),
                       trials[order[i]].end(),
                       [](const Trial& x, const Trial& y) { return x.distortion < y.distortion; });
    std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(first),
                     order.begin() + static_cast<std::ptrdiff_t>(last),
                     [&](size_t x, size_t y) { return distortion(x) < distortion(y); });
  };
  evaluate(0, candidates.size(), options.chains);
  const size_t finalists = std::min(candidates.size(), static_cast<size_t>(options.finalists));
  evaluate(0, finalists, options.final_chains);
  const size_t mirrored = append_mirrored(candidates, order, finalists, options.leaders);
  evaluate(finalists, finalists + mirrored, options.final_chains);
  Judgement judgement;
  for (const size_t c : order) {
    candidates[c].distortion = trials[c].empty() ? kInfinity : trials[c][0].distortion;
    judgement.ranking.push_back(candidates[c]);
  }
  const auto enter = [&](size_t i, size_t chain) {
    const auto& tried = trials[order[i]];
    if (chain < tried.size())
      judgement.finals.push_back({i,
                                  {*source_discs.find(tried[chain].source_chain),
                                   *target_discs.find(tried[chain].target_chain),
                                   tried[chain].distortion}});
  };
  const size_t chains = static_cast<size_t>(options.final_chains);
  for (size_t chain = 0; chain < chains; ++chain)
    for (size_t i = 0; i < finalists; ++i)
      if (judgement.finals.size() < static_cast<size_t>(options.finals)) enter(i, chain);
  for (size_t i = finalists; i < finalists + mirrored; ++i)
    for (size_t chain = 0; chain < std::min(chains, kMirroredChains); ++chain) enter(i, chain);
  if (judgement.finals.empty())
    return fail(ErrorCode::kNoCorrespondence, "judge: no candidate has a bijective map");
  return judgement;
}

double judged_energy(const SphereMap& map, double mean_energy) {
  // A tail without a counterpart takes the mean to any height; the mean of the logarithms tells
  // whether the rest fits.
  constexpr double kMeanWeight = 0.2;
  // Where both sides of a body fit alike this decides; elsewhere it is small beside the distortion.
  // Chosen on gorillas to humans and teddies, where correlations of right and mirrored maps are
  // about 0.5 apart and their distortions a few hundredths.
  constexpr double kChiralityWeight = 0.15;
  return kMeanWeight * std::log(mean_energy) + map.coarse_distortion() -
         kChiralityWeight * map.coarse_chirality();
}

Result<Verdict> play_finals(const Shape& source,
                            const Shape& target,
                            Judgement judgement,
                            const MapOptions& options,
                            const std::function<double(const SphereMap&)>& penalty) {
  const size_t count = judgement.finals.size();
  std::vector<std::unique_ptr<SphereMap>> maps(count);
  std::vector<double> energy(count, kInfinity);
  std::vector<Status> started(count);
  const auto judge_by = [&](size_t i, double mean_energy) {
    energy[i] = judged_energy(*maps[i], mean_energy) + (penalty ? penalty(*maps[i]) : 0);
  };
  tbb::parallel_for(size_t{0}, count, [&](size_t i) {
    const Final& final = judgement.finals[i];
    auto map = std::make_unique<SphereMap>(
        source, target, judgement.ranking[final.candidate].landmarks, options);
    started[i] = map->start(final.initial);
    if (!started[i]) return;
    maps[i] = std::move(map);
    judge_by(i, maps[i]->optimize_roughly());
  });
  std::vector<size_t> order(count), last;
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(
      order.begin(), order.end(), [&](size_t i, size_t j) { return energy[i] < energy[j]; });
  constexpr size_t kToTheEnd = 5;
  for (const size_t i : order) {
    const auto same = [&](size_t j) { return maps[j]->coarse_distance(*maps[i]) <= kSameMap; };
    if (maps[i] != nullptr && last.size() < kToTheEnd &&
        std::none_of(last.begin(), last.end(), same))
      last.push_back(i);
  }
  // What is so far behind stays behind: of 88 rivals seen to the end none became the winner from
  // more than 0.07 behind, and two came nearer by more than 0.12.
  constexpr double kHopeless = 0.2;
  const double bound = last.empty() ? 0 : energy[last[0]] + kHopeless;
  tbb::parallel_for(size_t{0}, last.size(), [&](size_t k) {
    if (energy[last[k]] <= bound) judge_by(last[k], maps[last[k]]->optimize_coarse());
  });
  for (Candidate& c : judgement.ranking) c.energy = kInfinity;
  for (size_t i = 0; i < count; ++i) {
    double& least = judgement.ranking[judgement.finals[i].candidate].energy;
    least = std::min(least, energy[i]);
  }
  const size_t best =
      static_cast<size_t>(std::min_element(energy.begin(), energy.end()) - energy.begin());
  if (maps[best] == nullptr) return tl::unexpected(started[0].error());
  const auto candidate = [&](size_t i) -> const Candidate& {
    return judgement.ranking[judgement.finals[i].candidate];
  };
  double margin = kInfinity, mirrored_margin = kInfinity;
  for (size_t i = 0; i < count; ++i)
    if (maps[i] != nullptr && maps[best]->coarse_distance(*maps[i]) > kSameMap) {
      margin = std::min(margin, energy[i] - energy[best]);
      if (exchanged_pairs(candidate(best), candidate(i)) > 0)
        mirrored_margin = std::min(mirrored_margin, energy[i] - energy[best]);
    }
  std::stable_sort(
      last.begin(), last.end(), [&](size_t i, size_t j) { return energy[i] < energy[j]; });
  Verdict verdict;
  verdict.margin = margin;
  verdict.mirrored_margin = mirrored_margin;
  for (const size_t i : last)
    if (maps[i] != nullptr)
      verdict.maps.push_back({std::move(maps[i]),
                              energy[i],
                              judgement.ranking[judgement.finals[i].candidate].landmarks});
  verdict.ranking = std::move(judgement.ranking);
  std::stable_sort(verdict.ranking.begin(),
                   verdict.ranking.end(),
                   [](const Candidate& a, const Candidate& b) { return a.energy < b.energy; });
  return verdict;
}

}  // namespace crosspatch
