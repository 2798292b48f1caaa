#include "param/match.hpp"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>

namespace crosspatch {
namespace {

using std::size_t;

/// Both surfaces at once.
template <class T, class Make>
Result<std::pair<T, T>> both(Make make) {
  Result<T> a = fail(ErrorCode::kInternal, "not run"), b = a;
  tbb::parallel_invoke([&] { a = make(0); }, [&] { b = make(1); });
  if (!a) return tl::unexpected(a.error());
  if (!b) return tl::unexpected(b.error());
  return std::pair<T, T>(std::move(*a), std::move(*b));
}

/// The given landmarks with each proposed assignment of tips that does not contradict them.
std::vector<Candidate> make_candidates(const ShapeFeatures& source,
                                       const ShapeFeatures& target,
                                       const std::vector<Landmark>& given,
                                       const ProposalOptions& options) {
  std::vector<Candidate> candidates;
  for (const TipAssignment& assignment :
       propose(tip_descriptors(source), tip_descriptors(target), options)) {
    Candidate found;
    for (const auto& [i, j] : assignment.pairs)
      found.landmarks.push_back({source.tips[static_cast<size_t>(i)].vertex,
                                 target.tips[static_cast<size_t>(j)].vertex,
                                 false});
    const Candidate fixed{given};
    if (contradicts(found, fixed)) continue;
    Candidate joined = fixed;
    for (const Landmark& l : found.landmarks)
      if (std::none_of(given.begin(), given.end(), [&](const Landmark& g) {
            return g.source_vertex == l.source_vertex;
          }))
        joined.landmarks.push_back(l);
    if (joined.landmarks.size() >= 2) candidates.push_back(std::move(joined));
  }
  return candidates;
}

std::vector<int> side(const std::vector<Candidate>& candidates, int Landmark::*vertex) {
  std::vector<int> vertices;
  for (const Candidate& c : candidates)
    for (const Landmark& l : c.landmarks) vertices.push_back(l.*vertex);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

Result<MatchedMap> match_and_map(const TriangleMesh& source,
                                 const TriangleMesh& target,
                                 const std::vector<Landmark>& given,
                                 const MatchOptions& options) {
  const auto stage = [&](const char* name) {
    if (options.progress) options.progress(name);
  };
  std::vector<Candidate> candidates{{given}};
  if (static_cast<int>(given.size()) < options.enough_landmarks) {
    stage("features");
    const auto features = both<ShapeFeatures>(
        [&](int i) { return compute_features(i == 0 ? source : target, options.features); });
    if (!features) return tl::unexpected(features.error());
    candidates = make_candidates(features->first, features->second, given, options.proposal);
    if (candidates.empty())
      return fail(ErrorCode::kNoCorrespondence,
                  fmt::format("match: {} and {} tips, no assignment agrees with the {} landmarks",
                              features->first.tips.size(),
                              features->second.tips.size(),
                              given.size()));
  }
  stage("embedding");
  auto shapes = both<Shape>([&](int i) {
    return make_shape(
        i == 0 ? source : target,
        side(candidates, i == 0 ? &Landmark::source_vertex : &Landmark::target_vertex),
        options.shape);
  });
  if (!shapes) return tl::unexpected(shapes.error());
  stage("judging");
  auto judgement = judge(shapes->first, shapes->second, std::move(candidates), options.judge);
  if (!judgement) return tl::unexpected(judgement.error());
  stage("map");
  auto result = optimize_map(shapes->first,
                             shapes->second,
                             judgement->winner,
                             judgement->ranking[0].landmarks,
                             options.map);
  if (!result) return tl::unexpected(result.error());
  return MatchedMap{std::move(judgement->ranking), judgement->margin, std::move(*result)};
}

}  // namespace crosspatch
