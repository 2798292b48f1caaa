#include "param/match.hpp"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "param/extremities.hpp"
#include "param/join_openings.hpp"

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

/// The given landmarks, alone and with each proposed assignment of the other tips.
std::vector<Candidate> make_candidates(const ShapeFeatures& source,
                                       const ShapeFeatures& target,
                                       const std::vector<Landmark>& given,
                                       ProposalOptions options) {
  std::vector<Candidate> candidates;
  if (given.size() >= 2) candidates.push_back({given});
  options.fixed = static_cast<int>(given.size());
  for (const TipAssignment& assignment :
       propose(tip_descriptors(source), tip_descriptors(target), options)) {
    Candidate candidate{given};
    for (const auto& [i, j] : assignment.pairs)
      if (i >= options.fixed)
        candidate.landmarks.push_back({source.tips[static_cast<size_t>(i)].vertex,
                                       target.tips[static_cast<size_t>(j)].vertex,
                                       false});
    if (candidate.landmarks.size() >= std::max<size_t>(2, given.size() + 1))
      candidates.push_back(std::move(candidate));
  }
  return candidates;
}

/// What stages after the proposals ask of the features.
void hand_over(ShapeFeatures features, Shape& shape) {
  shape.chirality = std::move(features.chirality);
  for (const Tip& extremity : features.extremities) shape.extremities.push_back(extremity.vertex);
  shape.extremity_distances = std::move(features.extremity_distances);
}

std::vector<int> side(const std::vector<Candidate>& candidates, int Landmark::*vertex) {
  std::vector<int> vertices;
  for (const Candidate& c : candidates)
    for (const Landmark& l : c.landmarks) vertices.push_back(l.*vertex);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

/// Places of coarse maps that differ from each other, from each place on: differing[i] begins with
/// i. To be asked before any of them is finished, which changes it.
std::vector<std::vector<size_t>> differing_maps(const Verdict& verdict) {
  const size_t count = verdict.maps.size();
  std::vector<std::vector<size_t>> differing(count);
  for (size_t first = 0; first < count; ++first) {
    std::vector<size_t>& chosen = differing[first];
    chosen.push_back(first);
    for (size_t i = 0; i < count; ++i) {
      const auto same = [&](size_t j) {
        return i == j || verdict.maps[j].map->coarse_distance(*verdict.maps[i].map) <= kSameMap;
      };
      if (std::none_of(chosen.begin(), chosen.end(), same)) chosen.push_back(i);
    }
  }
  return differing;
}

/// The map of two closed surfaces of any area.
Result<MatchedMap> match_closed(const TriangleMesh& source,
                                const TriangleMesh& target,
                                const std::vector<Landmark>& given,
                                const MatchOptions& options) {
  const auto stage = [&](const char* name) {
    if (options.progress) options.progress(name);
  };
  std::vector<Candidate> candidates{{given}};
  std::optional<std::pair<ShapeFeatures, ShapeFeatures>> features;
  if (static_cast<int>(given.size()) < options.enough_landmarks) {
    stage("features");
    auto found = both<ShapeFeatures>([&](int i) {
      const TriangleMesh& mesh = i == 0 ? source : target;
      std::vector<int> vertices;
      for (const Landmark& l : given)
        vertices.push_back(i == 0 ? l.source_vertex : l.target_vertex);
      return compute_features(mesh, options.features).map([&](ShapeFeatures own) {
        return with_landmarks(mesh, std::move(own), vertices);
      });
    });
    if (!found) return tl::unexpected(found.error());
    features = std::move(*found);
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
  if (features) {
    hand_over(std::move(features->first), shapes->first);
    hand_over(std::move(features->second), shapes->second);
  }
  stage("judging");
  auto judgement = judge(shapes->first, shapes->second, std::move(candidates), options.judge);
  if (!judgement) return tl::unexpected(judgement.error());
  stage("finals");
  auto verdict = play_finals(shapes->first, shapes->second, std::move(*judgement), options.map);
  if (!verdict) return tl::unexpected(verdict.error());
  const auto guided = guide_by_extremities(
      shapes->first, shapes->second, verdict->maps[0], options.shape, options.map);
  stage("map");
  MatchedMap matched;
  matched.ranking = std::move(verdict->ranking);
  matched.margin = verdict->margin;
  matched.mirrored_margin = verdict->mirrored_margin;
  // Where landmarks strain the map, the best coarse map may be too crumpled to be refined.
  const auto differing =
      options.alternatives > 0 ? differing_maps(*verdict) : std::vector<std::vector<size_t>>{};
  size_t winner = 0;
  Result<MapResult> result = fail(ErrorCode::kInternal, "not tried");
  if (guided) result = finish_map(*guided->map, shapes->first, shapes->second);
  for (size_t i = 0; i < verdict->maps.size() && !result; ++i) {
    result = finish_map(*verdict->maps[i].map, shapes->first, shapes->second);
    winner = i;
  }
  if (!result) return tl::unexpected(result.error());
  if (winner > 0) matched.margin = matched.mirrored_margin = 0;
  matched.result = std::move(*result);
  if (options.alternatives > 0) stage("others");
  for (const size_t i : differing.empty() ? std::vector<size_t>{} : differing[winner]) {
    if (i == winner || static_cast<int>(matched.alternatives.size()) >= options.alternatives)
      continue;
    const Verdict::CoarseMap& other = verdict->maps[i];
    if (auto finished = finish_map(*other.map, shapes->first, shapes->second))
      matched.alternatives.push_back(
          {other.landmarks, other.energy - verdict->maps[winner].energy, std::move(*finished)});
  }
  return matched;
}

}  // namespace

Result<MatchedMap> match_and_map(const TriangleMesh& source,
                                 const TriangleMesh& target,
                                 const std::vector<Landmark>& given,
                                 const MatchOptions& options) {
  const auto spheres =
      both<CappedSurface>([&](int i) { return cap_surface(i == 0 ? source : target); });
  if (!spheres) return tl::unexpected(spheres.error());
  const auto& [a, b] = *spheres;
  auto matched = match_closed(normalized(a.filled.mesh), normalized(b.filled.mesh), given, options);
  if (!matched) return matched;
  if (a.is_sphere() && b.is_sphere()) {
    matched->valid = validate(matched->result.map, source, target);
    return matched;
  }
  std::vector<int> kept;
  for (const Landmark& l : given) kept.push_back(l.source_vertex);
  const auto open = [&](MapResult& result) {
    JoinedMap joined = join_openings(result.map, source, a, target, b, kept);
    result.map = std::move(joined.map);
    result.quality = measure_map(result.map, source, target);
    return std::pair(joined.handles, joined.holes);
  };
  // Caps are no part of the surfaces; copies of vertices along cuts are known by the first of them.
  const auto on_surfaces = [&](std::vector<Landmark>& landmarks) {
    std::erase_if(landmarks, [&](const Landmark& l) {
      return l.source_vertex >= a.filled.vertex_count || l.target_vertex >= b.filled.vertex_count;
    });
    for (Landmark& l : landmarks) {
      l.source_vertex = a.cut.vertex[static_cast<size_t>(l.source_vertex)];
      l.target_vertex = b.cut.vertex[static_cast<size_t>(l.target_vertex)];
    }
  };
  std::tie(matched->handles, matched->holes) = open(matched->result);
  if (!matched->is_partial())
    matched->valid = validate(matched->result.map, source, target);
  else if (matched->handles[0] + matched->handles[1] == 0)
    matched->valid = validate_partial(matched->result.map, source, target);
  else
    matched->valid = validate_partial(matched->result.map, a.cut.mesh, b.cut.mesh);
  for (Alternative& other : matched->alternatives) {
    open(other.result);
    on_surfaces(other.landmarks);
  }
  for (Candidate& candidate : matched->ranking) on_surfaces(candidate.landmarks);
  return matched;
}

}  // namespace crosspatch
