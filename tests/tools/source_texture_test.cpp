#include "tools/source_texture.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "core/file_bytes.hpp"
#include "temp_folder.hpp"
#include "tools/image_io.hpp"

namespace crosspatch {
namespace {

/// One quad with texture coordinates, a red material and a foreign image.
PolygonSoup quad() {
  PolygonSoup soup;
  soup.positions.resize(4, 3);
  soup.positions << 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0;
  soup.polygon_begin = {0, 4};
  soup.corner_vertex = {0, 1, 2, 3};
  soup.uv_sets = {{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
  Material red;
  red.base_color_factor = {1, 0, 0, 1};
  soup.materials = {red};
  soup.polygon_material = {0};
  return soup;
}

TEST(SourceTexture, PaintsPicturesThatCanBeRead) {
  for (const char* what : {"checker", "uv"}) {
    PolygonSoup soup = quad();
    const Status given = give_texture(what, soup);
    ASSERT_TRUE(given) << given.error().message;
    EXPECT_TRUE(validate(soup));
    ASSERT_EQ(soup.images.size(), 1u);
    EXPECT_EQ(soup.images[0].mime_type, "image/png");
    EXPECT_EQ(soup.materials[0].base_color.image, 0);
    EXPECT_EQ(soup.materials[0].base_color_factor, (std::array<double, 4>{1, 1, 1, 1}));
    const auto bitmap = decode_image(soup.images[0].bytes);
    ASSERT_TRUE(bitmap);
    // The left edge is not like the right one, nor the upper like the lower.
    EXPECT_GT((pixel(*bitmap, 20, 20) - pixel(*bitmap, 1000, 20)).norm(), 0.3F) << what;
    EXPECT_GT((pixel(*bitmap, 20, 20) - pixel(*bitmap, 20, 1000)).norm(), 0.3F) << what;
  }
}

TEST(SourceTexture, KeepsTheBytesOfAFile) {
  const TempFolder folder;
  PolygonSoup painted = quad();
  ASSERT_TRUE(give_texture("uv", painted));
  const auto path = folder.path() / "hide.png";
  const std::vector<unsigned char>& bytes = painted.images[0].bytes;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  PolygonSoup soup = quad();
  ASSERT_TRUE(give_texture(path.string(), soup));
  EXPECT_EQ(soup.images[0].bytes, bytes);
  EXPECT_EQ(soup.images[0].name, "hide.png");
}

TEST(SourceTexture, ColoursByPlace) {
  PolygonSoup soup = quad();
  ASSERT_TRUE(give_texture("position", soup));
  EXPECT_TRUE(validate(soup));
  EXPECT_EQ(soup.corner_colors[0], (std::array<float, 4>{0, 0, 0, 1}));
  EXPECT_EQ(soup.corner_colors[2],
            (std::array<float, 4>{1, 0.5F, 0, 1}));  // one scale for all axes
}

TEST(SourceTexture, ColoursByDistortion) {
  PolygonSoup soup = quad();
  ASSERT_TRUE(give_texture("distortion", soup));
  FileNumbering numbering;
  numbering.mesh_vertex = {2, 1, 0, -1};  // the last was left out
  const Eigen::Vector3d energy(100, 40, 4);
  color_by_distortion(numbering, energy, soup);
  EXPECT_TRUE(validate(soup));
  const auto green = [&](int vertex) {
    for (std::size_t c = 0; c < soup.corner_vertex.size(); ++c)
      if (soup.corner_vertex[c] == vertex) return soup.corner_colors[c][1];
    return -1.0F;
  };
  EXPECT_EQ(green(3), 1);
  EXPECT_GT(green(0), 0.8);
  EXPECT_LT(green(1), green(0));
  EXPECT_LT(green(2), green(1));
}

TEST(SourceTexture, SaysWhatIsMissing) {
  PolygonSoup bare = quad();
  bare.uv_sets.clear();
  EXPECT_EQ(give_texture("checker", bare).error().message,
            "--texture checker: the source has no texture coordinates; 'position' needs none");
  PolygonSoup soup = quad();
  EXPECT_EQ(give_texture("no such file.png", soup).error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace crosspatch
