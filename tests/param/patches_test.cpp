#include "param/patches.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/morse_fields.hpp"
#include "param/copy_layout.hpp"
#include "param/overlay.hpp"
#include "param/tutte.hpp"

namespace crosspatch {
namespace {

struct Drawing {
  DrawnLayout drawn;
  TriangleMesh given;
};

Drawing draw(const TriangleMesh& mesh, const Eigen::VectorXd& values, double level) {
  auto gradient = discrete_gradient(mesh, values).value();
  const auto hierarchy = persistence_hierarchy(gradient, FieldScale::kLinear).value();
  gradient = simplify(std::move(gradient), hierarchy, level);
  return {draw_layout(quad_layout(gradient).value(), gradient).value(), mesh};
}

Drawing waves_on_sphere() {
  const TriangleMesh mesh = shapes::icosphere(3);
  return draw(mesh,
              (3 * mesh.V.col(0).array()).sin() + (4 * mesh.V.col(1).array()).cos() +
                  (3 * mesh.V.col(2).array() + 1).sin(),
              0.05);
}

Drawing waves_on_torus() {
  const TriangleMesh mesh = shapes::torus(3, 1, 30, 16);
  return draw(mesh, mesh.V.col(0).array() + 2 * (2 * mesh.V.col(1).array()).sin(), 0.05);
}

TriangleMesh turned_sphere() {
  TriangleMesh mesh = shapes::icosphere(3);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  mesh.V *= turn;
  return mesh;
}

/// The map of the drawn sphere to a sphere with other triangles that keeps every point in place.
SurfaceMap in_place(const DrawnLayout& drawn, const TriangleMesh& target) {
  MatrixX3d X = drawn.mesh.V;
  X.rowwise().normalize();
  return overlay_on_sphere(drawn.mesh, X, target, target.V).value();
}

TEST(CopyLayout, IdentityCopiesEveryArcAsItIs) {
  for (const Drawing& d : {waves_on_sphere(), waves_on_torus()}) {
    const auto copy = copy_layout(d.drawn, identity_map(d.drawn.mesh), d.drawn.mesh);
    ASSERT_TRUE(copy) << copy.error().message;
    EXPECT_TRUE(validate(*copy));
    EXPECT_EQ(copy->path, d.drawn.path);
    EXPECT_EQ(copy->patch, d.drawn.patch);
    EXPECT_EQ(copy->mesh.V, d.drawn.mesh.V);
  }
}

TEST(CopyLayout, DrawsTheSameCellsOnOtherTriangles) {
  const Drawing d = waves_on_sphere();
  const TriangleMesh target = turned_sphere();
  const auto copy = copy_layout(d.drawn, in_place(d.drawn, target), target);
  ASSERT_TRUE(copy) << copy.error().message;
  const Status valid = validate(*copy);
  EXPECT_TRUE(valid) << valid.error().message;
  EXPECT_NEAR(total_area(copy->mesh), total_area(target), 1e-12);
  // Nodes stay in place but for the two facetings: half an edge's sagitta, squared 0.15 over 8.
  for (std::size_t n = 0; n < copy->node_vertex.size(); ++n)
    EXPECT_LT(
        (copy->mesh.position(copy->node_vertex[n]) - d.drawn.mesh.position(d.drawn.node_vertex[n]))
            .norm(),
        0.01);
}

TEST(CopyLayout, MapsWithHolesAreRefused) {
  const Drawing d = waves_on_sphere();
  SurfaceMap map = identity_map(d.drawn.mesh);
  map.point_of_target_vertex[3] = -1;
  EXPECT_EQ(copy_layout(d.drawn, map, d.drawn.mesh).error().message,
            "layout: the map leaves a vertex out");
}

TEST(CopyLayout, ObjHasALineForEachArc) {
  const Drawing d = waves_on_torus();
  const std::string obj = layout_to_obj(d.drawn);
  std::size_t lines = 0;
  for (std::size_t at = obj.find("\nl "); at != std::string::npos; at = obj.find("\nl ", at + 1))
    ++lines;
  EXPECT_EQ(lines, d.drawn.path.size());
}

TEST(ArcFractions, RiseAndMirrorExactly) {
  const Drawing d = waves_on_sphere();
  for (const std::vector<int>& path : d.drawn.path) {
    const std::vector<double> s = arc_fractions(d.drawn.mesh, path);
    EXPECT_EQ(s.front(), 0);
    EXPECT_EQ(s.back(), 1);
    for (std::size_t i = 1; i < s.size(); ++i) {
      EXPECT_LT(s[i - 1], s[i]);
      EXPECT_EQ(1 - (1 - s[i]), s[i]);
    }
  }
}

TEST(PatchDisc, PatchesAreDiscsThatCoverTheSurfaceOnce) {
  for (const Drawing& d : {waves_on_sphere(), waves_on_torus()}) {
    std::vector<std::vector<double>> fractions;
    for (const auto& path : d.drawn.path) fractions.push_back(arc_fractions(d.drawn.mesh, path));
    const PatchCutter cutter(d.drawn);
    double area = 0;
    for (int f = 0; f < d.drawn.layout.face_count; ++f) {
      const auto disc = cutter.cut(f, fractions);
      ASSERT_TRUE(disc) << disc.error().message;
      EXPECT_EQ(euler_characteristic(disc->mesh), 1);
      EXPECT_EQ(boundary_loops(disc->mesh)[0].size(), disc->loop.size());
      for (const int parent : disc->parent_face)
        EXPECT_EQ(d.drawn.patch[static_cast<std::size_t>(parent)], f);
      area += total_area(disc->mesh);
    }
    EXPECT_NEAR(area, total_area(d.given), 1e-11);
  }
}

TEST(Patches, IdenticalSurfacesGetIdenticalCharts) {
  const Drawing d = waves_on_torus();
  const auto patches = parametrize_patches(d.drawn, d.drawn);
  ASSERT_TRUE(patches) << patches.error().message;
  for (const PatchPair& pair : *patches) {
    EXPECT_EQ(pair.source_chart.uv, pair.target_chart.uv);
    EXPECT_LE(pair.source_chart.energy_after, pair.source_chart.energy_before);
    EXPECT_TRUE(folded_faces(pair.source.mesh, pair.source_chart.uv).empty());
  }
}

TEST(Patches, MapIsABijection) {
  const Drawing d = waves_on_sphere();
  const TriangleMesh target = turned_sphere();
  const DrawnLayout copy = copy_layout(d.drawn, in_place(d.drawn, target), target).value();
  const auto patches = parametrize_patches(d.drawn, copy);
  ASSERT_TRUE(patches) << patches.error().message;
  for (const PatchPair& pair : *patches)
    for (std::size_t i = 0; i < pair.source.loop.size(); ++i)
      EXPECT_EQ(pair.source_chart.uv.row(pair.source.loop[i]),
                pair.target_chart.uv.row(pair.target.loop[i]));
  const auto map = patchwise_map(d.drawn, copy, *patches);
  ASSERT_TRUE(map) << map.error().message;
  Status valid = validate(*map, d.drawn.mesh, copy.mesh);
  EXPECT_TRUE(valid) << valid.error().message;
  const SurfaceMap given = on_given_meshes(*map, d.drawn, d.given, copy, target);
  valid = validate(given, d.given, target);
  EXPECT_TRUE(valid) << valid.error().message;
  // The surfaces coincide but for their triangles, so points move no farther than the charts of a
  // patch differ: a fraction of its size.
  double worst = 0;
  for (int i = 0; i < given.point_count(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    worst = std::max(
        worst, (position(d.given, given.source[at]) - position(target, given.target[at])).norm());
  }
  EXPECT_LT(worst, 0.3);
}

TEST(Patches, MapOfAnyGenusIsABijection) {
  // The torus with itself, drawn twice: every edge and vertex coincides.
  const Drawing d = waves_on_torus();
  const auto patches = parametrize_patches(d.drawn, d.drawn).value();
  const auto map = patchwise_map(d.drawn, d.drawn, patches);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_TRUE(validate(*map, d.drawn.mesh, d.drawn.mesh));
  const SurfaceMap given = on_given_meshes(*map, d.drawn, d.given, d.drawn, d.given);
  EXPECT_TRUE(validate(given, d.given, d.given));
  for (std::size_t i = 0; i < given.source.size(); ++i)
    EXPECT_LT((position(d.given, given.source[i]) - position(d.given, given.target[i])).norm(),
              1e-12);
}

TEST(Patches, DifferentLayoutsAreRefused) {
  EXPECT_EQ(parametrize_patches(waves_on_sphere().drawn, waves_on_torus().drawn).error().message,
            "patches: the two layouts differ");
}

}  // namespace
}  // namespace crosspatch
