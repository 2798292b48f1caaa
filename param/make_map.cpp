#include "param/make_map.hpp"

namespace crosspatch {

Result<MapResult> finish_map(SphereMap& coarse, const Shape& source, const Shape& target) {
  if (Status s = coarse.refine(); !s) return tl::unexpected(s.error());
  coarse.settle();
  auto map = coarse.overlay();
  if (!map) return tl::unexpected(map.error());
  MapResult result{std::move(*map), {}};
  result.quality = measure_map(result.map, source.mesh, target.mesh);
  return result;
}

Result<MapResult> optimize_map(const Shape& source,
                               const Shape& target,
                               const InitialMap& initial,
                               const std::vector<Landmark>& landmarks,
                               const MapOptions& options) {
  SphereMap map(source, target, landmarks, options);
  if (Status s = map.start(initial); !s) return tl::unexpected(s.error());
  map.optimize_roughly();
  map.optimize_coarse();
  return finish_map(map, source, target);
}

}  // namespace crosspatch
