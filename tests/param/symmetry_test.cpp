#include "param/symmetry.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/creatures.hpp"

namespace crosspatch {
namespace {

/// A creature that is its own mirror image under y -> -y, vertex for vertex.
struct Body {
  ShapeFeatures features;
  Shape shape;
};

Body even_body(int levels, double stretch = 1) {
  const TriangleMesh mesh = normalized(shapes::creature(levels,
                                                        stretch,
                                                        {Vector3d(1, 0.55, -1),
                                                         Vector3d(1, -0.55, -1),
                                                         Vector3d(-1.2, 0.6, -1.1),
                                                         Vector3d(-1.2, -0.6, -1.1),
                                                         Vector3d(2.2, 0, 1.2),
                                                         Vector3d(-0.8, 0, 0.2)}));
  ShapeFeatures features = compute_features(mesh).value();
  std::vector<int> tips;
  for (const Tip& tip : features.tips) tips.push_back(tip.vertex);
  Shape shape = make_shape(mesh, tips).value();
  return {std::move(features), std::move(shape)};
}

Vector3d across(const Vector3d& x) {
  return {x.x(), -x.y(), x.z()};
}

/// The tip that is nearest to a direction.
int tip(const Body& body, const Vector3d& direction) {
  const auto away = [&](const Tip& t) {
    return (body.shape.mesh.position(t.vertex).normalized() - direction.normalized()).norm();
  };
  return std::min_element(body.features.tips.begin(),
                          body.features.tips.end(),
                          [&](const Tip& a, const Tip& b) { return away(a) < away(b); })
      ->vertex;
}

/// The coarse map through all limbs, those of the second list to those of the first.
double asymmetry_through(const Body& a,
                         const Body& b,
                         const Reflections& reflections,
                         const std::vector<Vector3d>& from,
                         const std::vector<Vector3d>& to) {
  std::vector<Landmark> landmarks;
  for (std::size_t i = 0; i < from.size(); ++i)
    landmarks.push_back({tip(a, from[i]), tip(b, to[i]), false});
  const MapOptions options;
  SphereMap map(a.shape, b.shape, landmarks, options);
  EXPECT_TRUE(map.start(initial_maps(a.shape, b.shape, landmarks, 6).front()));
  map.optimize_roughly();
  return asymmetry(map, a.shape, b.shape, reflections);
}

TEST(Symmetry, AMirrorImageFacesOutwardsAndKeepsItsVertices) {
  const Body body = even_body(2);
  const Shape image = mirror_image(body.shape);
  const auto volume = [](const TriangleMesh& mesh) {
    double sum = 0;
    for (int f = 0; f < mesh.face_count(); ++f)
      sum += mesh.position(mesh.F(f, 0))
                 .dot(mesh.position(mesh.F(f, 1)).cross(mesh.position(mesh.F(f, 2)))) /
             6;
    return sum;
  };
  EXPECT_TRUE(validate(image.mesh));
  EXPECT_GT(volume(image.mesh), 0);
  EXPECT_NEAR(volume(image.mesh), volume(body.shape.mesh), 1e-12);  // rounding
  EXPECT_GT(volume(image.coarse.mesh), 0);
  EXPECT_EQ(image.coarse.vertex, body.shape.coarse.vertex);
  // The embedding and the levels belong to the faces that were turned.
  for (int f = 0; f < image.mesh.face_count(); ++f) {
    const auto x = [&](int k) -> Vector3d { return image.X.row(image.mesh.F(f, k)).transpose(); };
    EXPECT_GT(x(0).dot(x(1).cross(x(2))), 0) << f;
  }
  Refinement walk(image.progressive);
  while (!walk.done()) walk.split();
  EXPECT_EQ(walk.compact_faces(), image.mesh.F);
}

TEST(Symmetry, TheReflectionOfAnEvenBodyIsFound) {
  const Body body = even_body(3);
  const auto reflection = find_reflection(body.shape, body.features, MapOptions{});
  ASSERT_TRUE(reflection);
  double error = 0;
  for (int v = 0; v < body.shape.mesh.vertex_count(); ++v) {
    const int partner = reflection->partner[static_cast<std::size_t>(v)];
    error += (body.shape.mesh.position(partner) - across(body.shape.mesh.position(v))).norm();
  }
  EXPECT_LT(error / body.shape.mesh.vertex_count(), 0.02);  // sqrt(area); edges are 0.03 long
  EXPECT_GT(reflection->margin, 0.12);
  const std::vector<int> partners = exchanged_tips(*reflection, body.features);
  ASSERT_EQ(partners.size(), 6u);
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const Vector3d here = body.shape.mesh.position(body.features.tips[i].vertex);
    ASSERT_GE(partners[i], 0);
    const Vector3d there =
        body.shape.mesh.position(body.features.tips[static_cast<std::size_t>(partners[i])].vertex);
    EXPECT_LT((there - across(here)).norm(), 0.05);
  }
}

TEST(Symmetry, AMapThatTakesATailToALegDoesNotKeepIt) {
  const Body a = even_body(3), b = even_body(3, 1.2);
  const auto reflections =
      find_reflections({a.shape, b.shape}, {a.features, b.features}, MapOptions{});
  ASSERT_TRUE(reflections);
  EXPECT_EQ(reflections->trust(), 1);
  const Vector3d front(1, 0.55, -1), hind(-1.2, 0.6, -1.1), head(2.2, 0, 1.2), tail(-0.8, 0, 0.2);
  const std::vector<Vector3d> limbs{front, across(front), hind, across(hind), head, tail};
  EXPECT_LT(asymmetry_through(a, b, *reflections, limbs, limbs), 0.03);
  const std::vector<Vector3d> twisted{front, across(front), tail, hind, head, across(hind)};
  EXPECT_GT(asymmetry_through(a, b, *reflections, limbs, twisted), 0.1);
}

TEST(Symmetry, WhereTwoReflectionsAreAsGoodNoneIsTrusted) {
  Reflections reflections{{{}, 0.5}, {{}, 0.05}};
  EXPECT_EQ(reflections.trust(), 0);
  reflections.target.margin = 0.09;
  EXPECT_NEAR(reflections.trust(), 0.5, 1e-12);
}

}  // namespace
}  // namespace crosspatch
