#include "tools/benchmarks/sparse_shape.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "tools/input.hpp"

namespace crosspatch {
namespace {

Result<SparseShape> with_features(const std::string& label, PreparedMesh prepared) {
  const TriangleMesh unit = normalized(prepared.mesh);
  return compute_features(unit).and_then([&](ShapeFeatures features) {
    return matching_shape(unit, features).map([&](MatchingShape matching) {
      return SparseShape{label, std::move(prepared), std::move(features), std::move(matching)};
    });
  });
}

}  // namespace

Result<SparseShape> read_sparse_shape(const std::string& path) {
  return read_input(path).and_then([&](const InputMesh& input) {
    return with_features(std::filesystem::path(path).stem().string(), input.prepared);
  });
}

Result<SparseShape> make_sparse_shape(const std::string& label, TriangleMesh mesh) {
  PreparedMesh prepared;
  prepared.mesh = std::move(mesh);
  return with_features(label, std::move(prepared));
}

double JudgedMatching::share_within(double distance) const {
  if (errors.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto near =
      std::count_if(errors.begin(), errors.end(), [&](double error) { return error <= distance; });
  return static_cast<double>(near) / static_cast<double>(errors.size());
}

JudgedMatching match_sparsely(const SparseShape& source,
                              const SparseShape& target,
                              const Truth& truth,
                              const SpectralMatchingOptions& options) {
  JudgedMatching judged;
  if (auto matching = spectral_matching(source.matching, target.matching, options))
    judged.matching = std::move(*matching);
  if (!truth.pairs.empty())
    judged.errors = match_errors(judged.matching, truth, source.mesh(), target.mesh());
  return judged;
}

Truth identity_truth(int vertices) {
  Truth truth;
  truth.dense = true;
  for (int v = 0; v < vertices; ++v) truth.pairs.emplace_back(v, v);
  return truth;
}

}  // namespace crosspatch
