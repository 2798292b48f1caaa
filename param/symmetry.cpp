#include "param/symmetry.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace crosspatch {
namespace {

using std::size_t;

/// Energy per unit of asymmetry. Four-legged animals whose map takes a tail to a leg or a muzzle to
/// an ear have asymmetries of 0.1 to 0.3, right ones 0.01 to 0.07; by distortion alone some of the
/// wrong ones are better by up to 0.1.
constexpr double kAsymmetryWeight = 2;

void mirror(MatrixX3d& points) {
  points.col(0) = -points.col(0);
}

void turn_over(MatrixX3i& faces) {
  faces.col(1).swap(faces.col(2));
}

TriangleMesh mirror_image(const TriangleMesh& mesh) {
  MatrixX3d V = mesh.V;
  MatrixX3i F = mesh.F;
  mirror(V);
  turn_over(F);
  return make_mesh(std::move(V), std::move(F)).value();
}

Vector3d position(const TriangleMesh& mesh, const PlaceOnMesh& place) {
  Vector3d x = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    x += place.bary[k] * mesh.position(place.vertex[static_cast<size_t>(k)]);
  return x;
}

int nearest_vertex(const PlaceOnMesh& place) {
  Eigen::Index k = 0;
  place.bary.maxCoeff(&k);
  return place.vertex[static_cast<size_t>(k)];
}

bool is_involution(const TipAssignment& assignment) {
  return std::all_of(assignment.pairs.begin(), assignment.pairs.end(), [&](const auto& pair) {
    const std::pair<int, int> back(pair.second, pair.first);
    return std::find(assignment.pairs.begin(), assignment.pairs.end(), back) !=
           assignment.pairs.end();
  });
}

/// Mean distance, through space and in sqrt(area), of coarse vertices from where the map, done
/// twice, takes them.
double distance_to_inverse(const SphereMap& map, const Shape& shape) {
  const std::vector<int>& samples = shape.coarse.vertex;
  std::vector<int> images;
  for (const PlaceOnMesh& place : map.coarse_images(samples))
    images.push_back(nearest_vertex(place));
  const std::vector<PlaceOnMesh> twice = map.coarse_images(images);
  double sum = 0;
  for (size_t i = 0; i < samples.size(); ++i)
    sum += (position(shape.mesh, twice[i]) - shape.mesh.position(samples[i])).norm();
  return sum / static_cast<double>(samples.size());
}

}  // namespace

Shape mirror_image(const Shape& shape) {
  Shape image = shape;
  image.mesh = mirror_image(shape.mesh);
  image.coarse.mesh = mirror_image(shape.coarse.mesh);
  turn_over(image.progressive.coarsest);
  mirror(image.X);
  image.chirality = -shape.chirality;
  return image;
}

std::optional<Reflection> find_reflection(const Shape& shape,
                                          const ShapeFeatures& features,
                                          const MapOptions& options) {
  // A reflection is its own inverse, so that pairs of tips come in both directions. A body's own
  // costs next to nothing as a proposal: few are enough, and the judge's usual effort is not
  // needed.
  const ProposalOptions proposal{.keep = 200};
  constexpr size_t kMost = 24;
  const JudgeOptions few{.finalists = 5, .final_chains = 8, .finals = 5, .leaders = 0};
  const Shape image = mirror_image(shape);
  const TipDescriptors tips = tip_descriptors(features);
  std::vector<Candidate> candidates;
  for (const TipAssignment& assignment : propose(tips, tips, proposal)) {
    if (candidates.size() == kMost) break;
    if (assignment.pairs.size() < 2 || !is_involution(assignment)) continue;
    Candidate& candidate = candidates.emplace_back();
    for (const auto& [i, j] : assignment.pairs)
      candidate.landmarks.push_back({features.tips[static_cast<size_t>(i)].vertex,
                                     features.tips[static_cast<size_t>(j)].vertex,
                                     false});
  }
  auto judgement = judge(shape, image, std::move(candidates), few);
  if (!judgement) return std::nullopt;
  const auto penalty = [&](const SphereMap& map) {
    return kAsymmetryWeight * distance_to_inverse(map, shape);
  };
  const auto verdict = play_finals(shape, image, std::move(*judgement), options, penalty);
  if (!verdict) return std::nullopt;
  Reflection reflection{{}, verdict->margin};
  std::vector<int> vertices(static_cast<size_t>(shape.mesh.vertex_count()));
  std::iota(vertices.begin(), vertices.end(), 0);
  for (const PlaceOnMesh& place : verdict->maps[0].map->coarse_images(vertices))
    reflection.partner.push_back(nearest_vertex(place));
  return reflection;
}

std::vector<int> exchanged_tips(const Reflection& reflection, const ShapeFeatures& features) {
  constexpr double kNear = 0.1;  // what is released slips by less, and paws are farther apart
  std::vector<int> near;
  for (const Tip& tip : features.tips) {
    const int image = reflection.partner[static_cast<size_t>(tip.vertex)];
    Eigen::Index j = 0;
    const double distance = features.tip_distances.row(image).minCoeff(&j);
    near.push_back(distance < kNear ? static_cast<int>(j) : -1);
  }
  std::vector<int> exchanged(near.size(), -1);
  for (size_t i = 0; i < near.size(); ++i)
    if (near[i] >= 0 && near[static_cast<size_t>(near[i])] == static_cast<int>(i))
      exchanged[i] = near[i];
  return exchanged;
}

double Reflections::trust() const {
  // Where reflections were found that do not belong to each other, that of teddies, whose fronts
  // and backs are almost alike, or of a horse in gallop had margins up to 0.06.
  constexpr double kNone = 0.06, kFull = 0.12;
  return std::clamp((std::min(source.margin, target.margin) - kNone) / (kFull - kNone), 0.0, 1.0);
}

std::optional<Reflections> find_reflections(const std::pair<Shape, Shape>& shapes,
                                            const std::pair<ShapeFeatures, ShapeFeatures>& features,
                                            const MapOptions& options) {
  std::optional<Reflection> a, b;
  tbb::parallel_invoke([&] { a = find_reflection(shapes.first, features.first, options); },
                       [&] { b = find_reflection(shapes.second, features.second, options); });
  if (!a || !b) return std::nullopt;
  return Reflections{std::move(*a), std::move(*b)};
}

double asymmetry(const SphereMap& map,
                 const Shape& source,
                 const Shape& target,
                 const Reflections& reflections) {
  const std::vector<int>& samples = source.coarse.vertex;
  std::vector<int> partners;
  for (const int v : samples)
    partners.push_back(reflections.source.partner[static_cast<size_t>(v)]);
  const std::vector<PlaceOnMesh> images = map.coarse_images(samples),
                                 others = map.coarse_images(partners);
  double sum = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const int there = reflections.target.partner[static_cast<size_t>(nearest_vertex(images[i]))];
    sum += (position(target.mesh, others[i]) - target.mesh.position(there)).norm();
  }
  return sum / static_cast<double>(samples.size());
}

double symmetry_penalty(const SphereMap& map,
                        const Shape& source,
                        const Shape& target,
                        const Reflections& reflections) {
  // More than that would outweigh a map that is clearly less distorted, where a reflection is
  // wrong.
  constexpr double kMost = 0.2;
  const double trust = reflections.trust();
  if (trust == 0) return 0;
  return kAsymmetryWeight * trust * std::min(kMost, asymmetry(map, source, target, reflections));
}

}  // namespace crosspatch
