#include "tools/raster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapes.hpp"
#include "tools/palette.hpp"
#include "tools/scene_surface.hpp"

namespace crosspatch {
namespace {

/// The square [0, 1]^2 at height z, facing +z, in one colour.
Surface square(double z, const Color& color) {
  const TriangleMesh grid = shapes::grid(1);
  Surface surface = make_surface(grid.V.rowwise() + Eigen::RowVector3d(0, 0, z), grid.F);
  color_faces(surface, {color, color});
  return surface;
}

Camera looking_at_square(double pixel_size) {
  Camera camera;
  camera.centre = Vector3d(0.5, 0.5, 0);
  camera.pixel_size = pixel_size;
  return camera;
}

double covered_pixels(const Bitmap& bitmap) {
  double sum = 0;
  for (int y = 0; y < bitmap.height; ++y)
    for (int x = 0; x < bitmap.width; ++x) sum += 1 - pixel(bitmap, x, y).x();
  return sum;
}

TEST(Raster, CoversTheAreaOfASquareASphereAndARod) {
  const RasterOptions options{.width = 100, .height = 80, .samples = 4};
  Scene scene;
  scene.surfaces.push_back(square(0, Color::Zero()));
  // 40 x 40 pixels; its sides fall between samples.
  EXPECT_DOUBLE_EQ(covered_pixels(draw(scene, looking_at_square(1.0 / 40), options)), 1600);

  const Camera camera{.axes = Eigen::Matrix3d::Identity(), .centre = {0, 0, 0}, .pixel_size = 1};
  scene = {};
  scene.rods.push_back({Vector3d::Zero(), Vector3d::Zero(), 30, Color::Zero()});
  // Samples along the circle err by at most a part of its length: 1 % of the area here.
  EXPECT_NEAR(covered_pixels(draw(scene, camera, options)), std::numbers::pi * 900, 28);
  scene.rods[0] = {Vector3d(-20, 0, 3), Vector3d(20, 0, -3), 10, Color::Zero()};
  EXPECT_NEAR(covered_pixels(draw(scene, camera, options)), std::numbers::pi * 100 + 800, 11);
}

TEST(Raster, NearerThingsHideFartherOnesInAnyOrder) {
  const Color red(1, 0, 0), blue(0, 0, 1);
  for (const bool swapped : {false, true}) {
    Scene scene;
    scene.surfaces = {square(swapped ? 1 : 2, swapped ? blue : red),
                      square(swapped ? 2 : 1, swapped ? red : blue)};
    const Bitmap front = draw(scene, looking_at_square(0.1), {.width = 10, .height = 10});
    EXPECT_EQ(pixel(front, 5, 5).z(), 0);
    EXPECT_GT(pixel(front, 5, 5).x(), 0.5F);
    Camera behind = looking_at_square(0.1);
    behind.axes = Vector3d(-1, 1, -1).asDiagonal();
    const Bitmap back = draw(scene, behind, {.width = 10, .height = 10});
    EXPECT_EQ(pixel(back, 5, 5).x(), 0);
    EXPECT_GT(pixel(back, 5, 5).z(), 0.1F);
    EXPECT_LT(pixel(back, 5, 5).z(), 0.6F) << "inner sides are darker";
  }
}

TEST(Raster, TextureStandsAsGltfSays) {
  // Upper left red, upper right green, lower left blue, lower right white.
  Bitmap bitmap = make_bitmap(2, 2, Color::Ones());
  set_pixel(bitmap, 0, 0, Color(1, 0, 0));
  set_pixel(bitmap, 1, 0, Color(0, 1, 0));
  set_pixel(bitmap, 0, 1, Color(0, 0, 1));
  Scene scene;
  Texture texture = make_texture(bitmap);
  EXPECT_EQ(texture.levels.size(), 2u);
  texture.repeat_s = texture.repeat_t = false;
  scene.textures.push_back(std::move(texture));
  Surface surface = square(0, Color::Ones());
  surface.face_texture = {0, 0};
  surface.corner_uv.resize(6, 2);
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d p = surface.V.row(surface.F(f, k));
      surface.corner_uv.row(3 * f + k) << p.x(), 1 - p.y();  // v downwards
    }
  scene.surfaces.push_back(surface);
  const Bitmap drawn = draw(scene, looking_at_square(1.0 / 16), {.width = 16, .height = 16});
  const auto is = [&](int x, int y, bool r, bool g, bool b) {
    const Color c = pixel(drawn, x, y);
    return (c.x() > 0.5F) == r && (c.y() > 0.5F) == g && (c.z() > 0.5F) == b;
  };
  EXPECT_TRUE(is(2, 2, true, false, false));
  EXPECT_TRUE(is(13, 2, false, true, false));
  EXPECT_TRUE(is(2, 13, false, false, true));
  EXPECT_TRUE(is(13, 13, true, true, true));
}

TEST(Raster, DistantTexturesAreAveragedNotSkipped) {
  // Black and white texels in turn, 64 a pixel: without smaller copies pixels would be either.
  Bitmap bitmap = make_bitmap(64, 64, Color::Ones());
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      if ((x + y) % 2 == 0) set_pixel(bitmap, x, y, Color::Zero());
  Scene scene;
  scene.textures.push_back(make_texture(bitmap));
  Surface surface = square(0, Color::Ones());
  surface.face_texture = {0, 0};
  surface.corner_uv.resize(6, 2);
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k)
      surface.corner_uv.row(3 * f + k) = surface.V.row(surface.F(f, k)).head<2>();
  scene.surfaces.push_back(surface);
  const RasterOptions options{.width = 8, .height = 8, .samples = 1};
  const Bitmap drawn = draw(scene, looking_at_square(1.0 / 8), options);
  scene.surfaces[0].face_texture.clear();
  const Bitmap plain = draw(scene, looking_at_square(1.0 / 8), options);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)  // 2 %: rounding to 8 bits at each of three levels
      EXPECT_NEAR(pixel(drawn, x, y).x(), 0.5F * pixel(plain, x, y).x(), 0.02);
}

TEST(Raster, SrgbValuesSurviveTheWayThroughLinearLight) {
  for (int i = 0; i < 256; ++i)
    EXPECT_EQ(linear_to_srgb(srgb_to_linear(static_cast<std::uint8_t>(i))), i);
  EXPECT_NEAR(srgb_to_linear(188), 0.5, 0.005);  // IEC 61966-2-1: half the light is 188 / 255
  EXPECT_EQ(linear_to_srgb(-1), 0);
  EXPECT_EQ(linear_to_srgb(7), 255);
}

TEST(Palette, LightnessOfTheFieldColoursGrows) {
  const auto luminance = [](const Color& c) { return c.dot(Color(0.2126F, 0.7152F, 0.0722F)); };
  for (int i = 1; i <= 32; ++i) {
    EXPECT_GT(luminance(field_color(i / 32.0)), luminance(field_color((i - 1) / 32.0)));
    EXPECT_LT(luminance(heat_color(i / 32.0)), luminance(heat_color((i - 1) / 32.0)));
  }
  EXPECT_EQ(field_color(std::nan("")), neutral_color());
}

TEST(Palette, NeighbouringCategoriesDiffer) {
  for (int i = 0; i < 60; ++i)
    for (int j = i + 1; j < i + 6; ++j)
      EXPECT_GT((category_color(i) - category_color(j)).norm(), 0.1F) << i << " and " << j;
}

}  // namespace
}  // namespace crosspatch
