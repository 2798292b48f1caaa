#include "param/extremities.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/creatures.hpp"
#include "core/features.hpp"

namespace crosspatch {
namespace {

Shape creature_shape(int subdivisions) {
  const TriangleMesh mesh = normalized(shapes::creature(subdivisions));
  const ShapeFeatures features = compute_features(mesh).value();
  std::vector<int> vertices;
  for (const Tip& extremity : features.extremities) vertices.push_back(extremity.vertex);
  Shape shape = make_shape(mesh, vertices).value();
  shape.extremities = vertices;
  shape.extremity_distances = features.extremity_distances;
  return shape;
}

/// The vertex of a list that is nearest to a direction.
int nearest(const Shape& shape, const Vector3d& direction) {
  return *std::min_element(shape.extremities.begin(), shape.extremities.end(), [&](int v, int w) {
    const auto away = [&](int u) {
      return (shape.mesh.position(u).normalized() - direction.normalized()).norm();
    };
    return away(v) < away(w);
  });
}

std::vector<Landmark> limbs(const Shape& source, const Shape& target) {
  std::vector<Landmark> landmarks;
  for (const Vector3d& limb : shapes::limb_directions())
    landmarks.push_back({nearest(source, limb), nearest(target, limb), false});
  return landmarks;
}

TEST(Extremities, ThatSlippedAreTakenToTheirOwn) {
  const Shape source = creature_shape(3), target = creature_shape(4);
  std::vector<Landmark> landmarks = limbs(source, target);
  const std::vector<Landmark> others(landmarks.begin() + 4, landmarks.end());
  landmarks.resize(4);
  const auto initial = initial_maps(source, target, landmarks, 2);
  ASSERT_FALSE(initial.empty());
  const MapOptions options;
  SphereMap map(source, target, landmarks, options);
  ASSERT_TRUE(map.start(initial.front()));
  const std::vector<Landmark> slipped = slipped_extremities(map, source, target, landmarks);
  ASSERT_EQ(slipped.size(), others.size());
  for (const Landmark& other : others)
    EXPECT_TRUE(std::any_of(slipped.begin(), slipped.end(), [&](const Landmark& l) {
      return l.source_vertex == other.source_vertex && l.target_vertex == other.target_vertex &&
             !l.pinned;
    })) << other.source_vertex;
}

TEST(Extremities, OfASurfaceOntoItselfHaveNotSlipped) {
  const Shape shape = creature_shape(3);
  std::vector<Landmark> landmarks = limbs(shape, shape);
  landmarks.resize(3);
  const auto initial = initial_maps(shape, shape, landmarks, 2);
  ASSERT_FALSE(initial.empty());
  const MapOptions options;
  Verdict::CoarseMap winner{
      std::make_unique<SphereMap>(shape, shape, landmarks, options), 0, landmarks};
  ASSERT_TRUE(winner.map->start(initial.front()));
  winner.map->optimize_coarse();
  EXPECT_TRUE(slipped_extremities(*winner.map, shape, shape, landmarks).empty());
  EXPECT_FALSE(guide_by_extremities(shape, shape, winner, {}, options));
}

}  // namespace
}  // namespace crosspatch
