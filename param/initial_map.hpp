#pragma once

#include <map>
#include <utility>
#include <vector>

#include "param/chain_disc.hpp"
#include "param/shape.hpp"

namespace crosspatch {

/// A point of the source and the point of the target it is mapped to.
struct Landmark {
  int source_vertex = -1;
  int target_vertex = -1;
  bool pinned = true;  ///< exact in the result; else it only decides the homotopy class and is
                       ///< released in the end
};

/// Chooses the orders in which chains visit landmarks.
class ChainPlanner {
 public:
  ChainPlanner(const Shape& source, const Shape& target) : source_(source), target_(target) {}

  /// Up to `count` pairs of chains (vertices of the coarse levels) through the landmarks, those of
  /// least total length on both surfaces first; every order is looked at for up to 7 landmarks.
  /// None if a landmark is not a vertex of the coarse levels.
  [[nodiscard]] std::vector<std::pair<std::vector<int>, std::vector<int>>> chains(
      const std::vector<Landmark>& landmarks, int count) const;

 private:
  const std::vector<double>& distances(const Shape& shape,
                                       std::map<int, std::vector<double>>& known,
                                       int vertex) const;

  const Shape& source_;
  const Shape& target_;
  mutable std::map<int, std::vector<double>> source_distances_, target_distances_;
};

/// A map found on the coarse levels, before any optimisation.
struct InitialMap {
  ChainDisc source_disc, target_disc;
  double distortion = 0;  ///< disc_distortion of the two
};

/// Cuts both coarse levels along up to `chains` chains through the landmarks (in the orders of
/// least total length); the pairs of discs by their distortion. Landmarks are vertices of the full
/// meshes. Empty if no chain can be cut, or for fewer than two landmarks.
std::vector<InitialMap> initial_maps(const Shape& source,
                                     const Shape& target,
                                     const std::vector<Landmark>& landmarks,
                                     int chains);

}  // namespace crosspatch
