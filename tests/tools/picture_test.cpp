// Whole pictures against stored ones. 4 levels of mean difference are below what is noticed side by
// side; 40 levels of one blurred pixel are the rounding of a thin line or a specular edge.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pictures.hpp"
#include "shapes.hpp"
#include "tools/figure.hpp"
#include "tools/palette.hpp"
#include "tools/scene_pair.hpp"
#include "tools/scene_surface.hpp"

namespace crosspatch {
namespace {

void expect_as_stored(const Bitmap& picture, const std::string& name) {
  const test::Difference d = test::difference_to_stored(picture, name);
  EXPECT_LT(d.mean, 4) << name;
  EXPECT_LT(d.worst, 40) << name;
}

Surface surface_of(const TriangleMesh& mesh) {
  return make_surface(mesh.V, mesh.F);
}

Panel panel(int scene, const char* view, const char* label) {
  return {scene, view_axes(axis_frame('z'), parse_view(view).value()), label};
}

TEST(Picture, FieldPatchesHeatAndCurves) {
  const TriangleMesh torus = shapes::torus(2, 0.8, 60, 30);
  std::vector<Scene> scenes(4);
  for (Scene& scene : scenes) scene.surfaces.push_back(surface_of(torus));
  color_field(scenes[0].surfaces[0], torus.V.col(0));
  std::vector<int> label(static_cast<std::size_t>(torus.face_count()));
  Eigen::VectorXd heat(torus.face_count());
  for (int f = 0; f < torus.face_count(); ++f) {
    label[static_cast<std::size_t>(f)] = f / 600 - 1;  // 60 faces a ring: ten rings a patch
    heat[f] = std::abs(torus.V(torus.F(f, 0), 1));
  }
  color_patches(scenes[1].surfaces[0], label);
  color_heat(scenes[2].surfaces[0], heat, {.low = 0, .high = 2.8});
  std::vector<Vector3d> knot;
  for (int i = 0; i <= 200; ++i) {
    const double t = 2 * std::numbers::pi * i / 200, r = 2 + 0.8 * std::cos(3 * t);
    knot.emplace_back(r * std::cos(2 * t), r * std::sin(2 * t), 0.8 * std::sin(3 * t));
  }
  add_curve(scenes[3], knot, 0.05, category_color(0));
  add_points(scenes[3], torus.V.topRows(30), 0.1, category_color(1));
  expect_as_stored(draw_figure(scenes,
                               {panel(0, "top", "field"),
                                panel(1, "quarter", "patches"),
                                panel(2, "quarter", "distortion"),
                                panel(3, "quarter", "curve (2, 3)")},
                               {.width = 320, .height = 240}),
                   "kinds");
}

TEST(Picture, CorrespondingPlacesLookAlike) {
  // The same ball twice: once stretched, so that the map is the identity of vertices.
  const TriangleMesh target = shapes::icosphere(3);
  TriangleMesh source = target;
  source.V = (source.V * Vector3d(1, 0.6, 1.5).asDiagonal()).eval();
  std::vector<SurfacePoint> map;
  for (int v = 0; v < source.vertex_count(); ++v) map.push_back(point_at_vertex(target, v));
  for (int v = 0; v < 3; ++v) map[static_cast<std::size_t>(v)] = SurfacePoint{};
  Scene first, second;
  first.surfaces.push_back(surface_of(source));
  second.surfaces.push_back(surface_of(target));
  const MatrixX3d places = image_positions(map, target.V, target.F);
  EXPECT_TRUE(places.topRows(3).array().isNaN().all());
  EXPECT_LT((places.bottomRows(600) - target.V.bottomRows(600)).norm(), 1e-12);
  color_by_place(first.surfaces[0], places, target.V, PairPattern::kChecker);
  color_by_place(second.surfaces[0], target.V, target.V, PairPattern::kChecker);
  const Panel front = panel(0, "front", "pair");
  PlacedPair pair =
      place_beside(first, second, Eigen::Matrix3d::Identity(), front.axes.row(0).transpose());
  MatrixX3d ends = target.V.middleRows(12, 8);
  for (auto end : ends.rowwise()) end = pair.placed(end.transpose()).transpose();
  add_correspondences(pair.scene, source.V.middleRows(12, 8), ends, 0.01);
  expect_as_stored(draw_figure({pair.scene}, {front}, {.width = 320, .height = 160}), "pair");
}

TEST(Picture, SoupWithTextureAndQuads) {
  PolygonSoup soup;
  const int n = 8;
  soup.positions.resize(n * n, 3);
  for (int i = 0; i < n * n; ++i) soup.positions.row(i) << i % n, i / n, std::sin(i % n * 0.8);
  soup.uv_sets.emplace_back();
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      for (const auto& [x, y] : {std::pair{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}) {
        soup.corner_vertex.push_back(y * n + x);
        soup.uv_sets[0].emplace_back(x / double(n - 1), 1 - y / double(n - 1));
      }
      soup.polygon_begin.push_back(static_cast<int>(soup.corner_vertex.size()));
    }
  soup.polygon_material.assign(49, 0);
  Bitmap stripes = make_bitmap(32, 32, Color(0.8F, 0.1F, 0.05F));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      if (x + y < 16 || x % 8 == 0) set_pixel(stripes, x, y, Color(0.1F, 0.3F, 0.9F));
  soup.images.push_back({"stripes.png", "image/png", encode_png(stripes).value()});
  soup.materials.emplace_back();
  soup.materials[0].base_color.image = 0;
  EXPECT_EQ(plain_surface(soup).F.rows(), 98);
  const Result<Scene> scene = textured_scene(soup);
  ASSERT_TRUE(scene) << scene.error().message;
  expect_as_stored(draw_figure({*scene},
                               {panel(0, "top", "top"), panel(0, "bottom", "bottom")},
                               {.width = 240, .height = 120}),
                   "texture");
  soup.images[0].bytes.resize(40);
  EXPECT_EQ(textured_scene(soup).error().message.substr(0, 22), "'stripes.png': image: ");
}

TEST(Picture, MatrixIsRowsFromTheTop) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(3, 5);
  M(0, 4) = 2;
  const Bitmap picture = draw_matrix(M, 50, 31);
  EXPECT_EQ(picture.width, 50);
  EXPECT_EQ(picture.height, 30);
  EXPECT_GT(pixel(picture, 45, 5).y(), pixel(picture, 45, 25).y());
  EXPECT_EQ(pixel(picture, 5, 5), pixel(picture, 5, 25));
}

}  // namespace
}  // namespace crosspatch
