#include "param/judge.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <map>
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

/// The trials of the candidates before `last`, evaluated.
std::vector<Trial> run_trials(const ChainPlanner& planner,
                              const std::vector<Candidate>& candidates,
                              size_t last,
                              int chains,
                              DiscCache& source,
                              DiscCache& target) {
  std::vector<Trial> trials;
  for (size_t c = 0; c < last; ++c)
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

}  // namespace

bool contradicts(const Candidate& a, const Candidate& b) {
  for (const Landmark& p : a.landmarks)
    for (const Landmark& q : b.landmarks)
      if ((p.source_vertex == q.source_vertex) != (p.target_vertex == q.target_vertex)) return true;
  return false;
}

Result<Judgement> judge(const Shape& source,
                        const Shape& target,
                        std::vector<Candidate> candidates,
                        const JudgeOptions& options) {
  const ChainPlanner planner(source, target);
  DiscCache source_discs(source), target_discs(target);
  const auto evaluate = [&](size_t last, int chains) {
    std::vector<Trial> trials =
        run_trials(planner, candidates, last, chains, source_discs, target_discs);
    for (size_t c = 0; c < last; ++c) candidates[c].distortion = kInfinity;
    for (const Trial& t : trials)
      candidates[t.candidate].distortion =
          std::min(candidates[t.candidate].distortion, t.distortion);
    std::stable_sort(
        candidates.begin(),
        candidates.begin() + static_cast<std::ptrdiff_t>(last),
        [](const Candidate& a, const Candidate& b) { return a.distortion < b.distortion; });
  };
  evaluate(candidates.size(), options.chains);
  const size_t finalists = std::min(candidates.size(), static_cast<size_t>(options.finalists));
  evaluate(finalists, options.final_chains);
  if (candidates.empty() || candidates[0].distortion == kInfinity)
    return fail(ErrorCode::kNoCorrespondence, "judge: no candidate has a bijective map");
  auto winner = initial_map(source, target, candidates[0].landmarks, options.final_chains);
  if (!winner) return tl::unexpected(winner.error());
  Judgement judgement{std::move(candidates), std::move(*winner), kInfinity};
  for (const Candidate& c : judgement.ranking)
    if (contradicts(c, judgement.ranking[0]))
      judgement.margin = std::min(judgement.margin, c.distortion - judgement.ranking[0].distortion);
  return judgement;
}

}  // namespace crosspatch
