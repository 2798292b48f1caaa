#include "param/match.hpp"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "param/extremities.hpp"
#include "param/join_openings.hpp"
#include "param/symmetry.hpp"

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

/// Assignments of the tips, those that the reflections agree with first, and how many these are.
std::pair<std::vector<TipAssignment>, size_t> propose_for(
    const std::pair<ShapeFeatures, ShapeFeatures>& features,
    const std::optional<Reflections>& reflections,
    const ProposalOptions& options) {
  const TipDescriptors a = tip_descriptors(features.first), b = tip_descriptors(features.second);
  std::vector<TipAssignment> assignments;
  const double trust = reflections ? reflections->trust() : 0;
  if (trust > 0) {
    constexpr double kShare = 2.0 / 3;
    ProposalOptions symmetric = options;
    symmetric.keep = static_cast<int>(std::lround(kShare * trust * options.keep));
    symmetric.source_partner = exchanged_tips(reflections->source, features.first);
    symmetric.target_partner = exchanged_tips(reflections->target, features.second);
    assignments = propose(a, b, symmetric);
  }
  const size_t agreeing = assignments.size();
  for (TipAssignment& assignment : propose(a, b, options)) {
    const auto same = [&](const TipAssignment& other) { return other.pairs == assignment.pairs; };
    if (static_cast<int>(assignments.size()) < options.keep &&
        std::none_of(assignments.begin(), assignments.end(), same))
      assignments.push_back(std::move(assignment));
  }
  return {std::move(assignments), agreeing};
}

/// The given landmarks, alone and with each proposed assignment of the other tips.
std::vector<Candidate> make_candidates(const std::pair<ShapeFeatures, ShapeFeatures>& features,
                                       const std::vector<Landmark>& given,
                                       const std::optional<Reflections>& reflections,
                                       ProposalOptions options) {
  // Of the distortion, as much as a map that tears pairs apart mostly pays in the finals. Some of
  // these get there all the same: reflections may be wrong.
  constexpr double kDisagrees = 0.3;
  options.fixed = static_cast<int>(given.size());
  const auto [assignments, agreeing] = propose_for(features, reflections, options);
  std::vector<Candidate> candidates;
  if (given.size() >= 2) candidates.push_back({given});
  for (size_t a = 0; a < assignments.size(); ++a) {
    Candidate candidate{given};
    if (reflections && a >= agreeing) candidate.prior = kDisagrees * reflections->trust();
    for (const auto& [i, j] : assignments[a].pairs)
      if (i >= options.fixed)
        candidate.landmarks.push_back({features.first.tips[static_cast<size_t>(i)].vertex,
                                       features.second.tips[static_cast<size_t>(j)].vertex,
                                       false});
    if (candidate.landmarks.size() >= std::max<size_t>(2, given.size() + 1))
      candidates.push_back(std::move(candidate));
  }
  return candidates;
}

/// What stages after the proposals ask of the features.
void hand_over(const ShapeFeatures& features, Shape& shape) {
  shape.chirality = features.chirality;
  for (const Tip& extremity : features.extremities) shape.extremities.push_back(extremity.vertex);
  shape.extremity_distances = features.extremity_distances;
}

std::vector<int> vertices_of(const std::vector<Landmark>& landmarks, int Landmark::*vertex) {
  std::vector<int> vertices;
  for (const Landmark& l : landmarks) vertices.push_back(l.*vertex);
  return vertices;
}

/// Both surfaces, with coarse levels that hold landmarks and tips.
Result<std::pair<Shape, Shape>> make_shapes(const TriangleMesh& source,
                                            const TriangleMesh& target,
                                            const std::vector<Landmark>& given,
                                            const std::vector<Tip>& source_tips,
                                            const std::vector<Tip>& target_tips,
                                            const ShapeOptions& options) {
  return both<Shape>([&](int i) {
    std::vector<int> held =
        vertices_of(given, i == 0 ? &Landmark::source_vertex : &Landmark::target_vertex);
    for (const Tip& tip : i == 0 ? source_tips : target_tips) held.push_back(tip.vertex);
    std::sort(held.begin(), held.end());
    held.erase(std::unique(held.begin(), held.end()), held.end());
    return make_shape(i == 0 ? source : target, held, options);
  });
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

/// What the judge is given.
struct Contest {
  std::pair<Shape, Shape> shapes;
  std::vector<Candidate> candidates;
  std::optional<Reflections> reflections;  ///< empty too where nobody looked
};

using Stage = std::function<void(const char*)>;

Result<Contest> without_features(const TriangleMesh& source,
                                 const TriangleMesh& target,
                                 const std::vector<Landmark>& given,
                                 const MatchOptions& options,
                                 const Stage& stage) {
  stage("embedding");
  return make_shapes(source, target, given, {}, {}, options.shape)
      .map([&](std::pair<Shape, Shape> shapes) {
        return Contest{std::move(shapes), {{given}}, std::nullopt};
      });
}

Result<Contest> with_features(const TriangleMesh& source,
                              const TriangleMesh& target,
                              const std::vector<Landmark>& given,
                              const MatchOptions& options,
                              const Stage& stage) {
  stage("features");
  auto features = both<ShapeFeatures>(
      [&](int i) { return compute_features(i == 0 ? source : target, options.features); });
  if (!features) return tl::unexpected(features.error());
  auto& [a, b] = *features;
  stage("embedding");
  auto shapes = make_shapes(source, target, given, a.tips, b.tips, options.shape);
  if (!shapes) return tl::unexpected(shapes.error());
  hand_over(a, shapes->first);
  hand_over(b, shapes->second);
  stage("symmetry");
  Contest contest{std::move(*shapes), {}, std::nullopt};
  contest.reflections = find_reflections(contest.shapes, *features, options.map);
  a = with_landmarks(source, std::move(a), vertices_of(given, &Landmark::source_vertex));
  b = with_landmarks(target, std::move(b), vertices_of(given, &Landmark::target_vertex));
  contest.candidates = make_candidates(*features, given, contest.reflections, options.proposal);
  if (contest.candidates.empty())
    return fail(ErrorCode::kNoCorrespondence,
                fmt::format("match: {} and {} tips, no assignment agrees with the {} landmarks",
                            a.tips.size(),
                            b.tips.size(),
                            given.size()));
  return contest;
}

/// The map of two closed surfaces of any area.
Result<MatchedMap> match_closed(const TriangleMesh& source,
                                const TriangleMesh& target,
                                const std::vector<Landmark>& given,
                                const MatchOptions& options) {
  const auto stage = [&](const char* name) {
    if (options.progress) options.progress(name);
  };
  const bool decided = static_cast<int>(given.size()) >= options.enough_landmarks;
  auto contest =
      (decided ? without_features : with_features)(source, target, given, options, stage);
  if (!contest) return tl::unexpected(contest.error());
  const auto& [a, b] = contest->shapes;
  const std::optional<Reflections>& reflections = contest->reflections;
  const auto penalty = [&](const SphereMap& map) {
    return reflections ? symmetry_penalty(map, a, b, *reflections) : 0;
  };
  stage("judging");
  auto judgement = judge(a, b, std::move(contest->candidates), options.judge);
  if (!judgement) return tl::unexpected(judgement.error());
  stage("finals");
  auto verdict = play_finals(a, b, std::move(*judgement), options.map, penalty);
  if (!verdict) return tl::unexpected(verdict.error());
  const auto guided = guide_by_extremities(a, b, verdict->maps[0], options.shape, options.map);
  stage("map");
  MatchedMap matched;
  matched.ranking = std::move(verdict->ranking);
  matched.margin = verdict->margin;
  matched.mirrored_margin = verdict->mirrored_margin;
  if (reflections && reflections->trust() >= 1)
    matched.asymmetry = asymmetry(*verdict->maps[0].map, a, b, *reflections);
  // Where landmarks strain the map, the best coarse map may be too crumpled to be refined.
  const auto differing =
      options.alternatives > 0 ? differing_maps(*verdict) : std::vector<std::vector<size_t>>{};
  size_t winner = 0;
  Result<MapResult> result = fail(ErrorCode::kInternal, "not tried");
  if (guided) result = finish_map(*guided->map, a, b);
  for (size_t i = 0; i < verdict->maps.size() && !result; ++i) {
    result = finish_map(*verdict->maps[i].map, a, b);
    winner = i;
  }
  if (!result) return tl::unexpected(result.error());
  if (winner > 0) {
    matched.margin = matched.mirrored_margin = 0;
    matched.asymmetry.reset();  // the other map's
  }
  matched.result = std::move(*result);
  if (options.alternatives > 0) stage("others");
  for (const size_t i : differing.empty() ? std::vector<size_t>{} : differing[winner]) {
    if (i == winner || static_cast<int>(matched.alternatives.size()) >= options.alternatives)
      continue;
    const Verdict::CoarseMap& other = verdict->maps[i];
    if (auto finished = finish_map(*other.map, a, b))
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
