#include "core/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/chirality.hpp"
#include "core/geodesics.hpp"

namespace crosspatch {

Result<std::vector<Tip>> canonical_tips(const TriangleMesh& mesh,
                                        const Eigen::VectorXd& log_adf,
                                        double persistence) {
  // Already logarithms, hence the linear scale.
  const auto complex =
      morse_smale_complex(mesh, log_adf, {.threshold = persistence, .scale = FieldScale::kLinear});
  if (!complex) return tl::unexpected(complex.error());
  std::vector<Tip> tips;
  for (const MorseNode& node : complex->nodes)
    if (node.kind == NodeKind::kMaximum)
      tips.push_back({node.vertex, std::min(1.0, node.persistence), node.value});
  std::sort(tips.begin(), tips.end(), [](const Tip& a, const Tip& b) {
    return std::tuple(-a.persistence, a.vertex) < std::tuple(-b.persistence, b.vertex);
  });
  return tips;
}

Result<ShapeFeatures> compute_features(const TriangleMesh& mesh, const FeatureOptions& options) {
  constexpr int kLeastVertices = 4;  // of a tetrahedron; the wave kernel needs three eigenpairs
  if (mesh.vertex_count() < kLeastVertices)
    return fail(
        ErrorCode::kBadInput,
        fmt::format(
            "mesh: {} vertices, at least {} are needed", mesh.vertex_count(), kLeastVertices));
  auto spectrum = compute_spectrum(mesh, options.spectrum);
  if (!spectrum) return tl::unexpected(spectrum.error());
  ShapeFeatures features;
  features.log_adf = auto_diffusion(*spectrum, options.adf).array().log();
  features.log_hks = log_heat_kernel_signature(*spectrum, options.hks);
  features.wks = wave_kernel_signature(*spectrum, options.wks);
  auto chirality = chirality_fields(mesh, *spectrum);
  if (!chirality) return tl::unexpected(chirality.error());
  features.chirality = std::move(*chirality);
  features.spectrum = std::move(*spectrum);
  auto extremities = canonical_tips(
      mesh, features.log_adf, std::min(options.extremity_persistence, options.tip_persistence));
  if (!extremities) return tl::unexpected(extremities.error());
  features.extremities = std::move(*extremities);
  const auto count = [&](double persistence, int most) {
    const auto lesser = std::find_if(
        features.extremities.begin(), features.extremities.end(), [&](const Tip& extremity) {
          return extremity.persistence < persistence;
        });
    return std::min(lesser - features.extremities.begin(), static_cast<std::ptrdiff_t>(most));
  };
  features.tips.assign(
      features.extremities.begin(),
      features.extremities.begin() + count(options.tip_persistence, options.max_tips));
  features.extremities.resize(
      static_cast<std::size_t>(count(options.extremity_persistence, options.max_extremities)));
  std::vector<int> vertices;
  for (const Tip& extremity : features.extremities) vertices.push_back(extremity.vertex);
  const double unit = std::sqrt(total_area(mesh));
  features.extremity_distances = geodesic_distances(mesh, vertices) / unit;
  vertices.resize(features.tips.size());
  while (static_cast<int>(vertices.size()) < std::min(options.least_tips, mesh.vertex_count())) {
    Eigen::Index farthest = 0;
    geodesic_distance_to_set(mesh, vertices).maxCoeff(&farthest);
    vertices.push_back(static_cast<int>(farthest));
    features.tips.push_back({vertices.back(), 0, features.log_adf[farthest]});
  }
  features.tip_distances = geodesic_distances(mesh, vertices) / unit;
  return features;
}

ShapeFeatures with_landmarks(const TriangleMesh& mesh,
                             ShapeFeatures features,
                             const std::vector<int>& landmarks,
                             double clearance) {
  if (landmarks.empty()) return features;
  const double unit = std::sqrt(total_area(mesh));
  const Eigen::VectorXd distance = geodesic_distance_to_set(mesh, landmarks) / unit;
  std::erase_if(features.tips, [&](const Tip& tip) { return distance[tip.vertex] <= clearance; });
  std::vector<Tip> tips;
  for (const int v : landmarks) tips.push_back({v, 1, features.log_adf[v]});
  features.tips.insert(features.tips.begin(), tips.begin(), tips.end());
  std::vector<int> vertices;
  for (const Tip& tip : features.tips) vertices.push_back(tip.vertex);
  features.tip_distances = geodesic_distances(mesh, vertices) / unit;
  return features;
}

}  // namespace crosspatch
