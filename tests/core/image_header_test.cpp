#include "core/image_header.hpp"

#include <gtest/gtest.h>

#include "mesh_files.hpp"

namespace crosspatch {
namespace {

Result<ImageHeader> sniff(const std::string& bytes) {
  return sniff_image({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

TEST(ImageHeader, SizesOfPngAndJpegAreRead) {
  const auto png = sniff(files::png_header(640, 480)), jpeg = sniff(files::jpeg_header(300, 200));
  ASSERT_TRUE(png && jpeg);
  EXPECT_EQ(png->width, 640);
  EXPECT_EQ(png->height, 480);
  EXPECT_EQ(png->mime_type, "image/png");
  EXPECT_EQ(jpeg->width, 300);
  EXPECT_EQ(jpeg->height, 200);
  EXPECT_EQ(jpeg->mime_type, "image/jpeg");
}

TEST(ImageHeader, EveryTruncationIsAnError) {
  for (const std::string& whole : {files::png_header(4, 4), files::jpeg_header(4, 4)})
    for (std::size_t n = 0; n + 4 < whole.size(); ++n)  // 4: the PNG checksum is not looked at
      EXPECT_FALSE(sniff(whole.substr(0, n))) << n;
}

TEST(ImageHeader, SidesOutsideTheLimitsAreNamed) {
  EXPECT_EQ(sniff(files::png_header(30000, 20)).error().message,
            "image of 30000 x 20 texels: sides must be 1 to 16384, the area at most 268435456");
  EXPECT_FALSE(sniff(files::png_header(0, 20)));
  EXPECT_FALSE(sniff(files::png_header(20, 0xffffffff)));
  EXPECT_FALSE(sniff(files::jpeg_header(60000, 60000)));
  const std::string png = files::png_header(2000, 2000);
  const ReadLimits small{.max_image_texels = 1'000'000};
  EXPECT_FALSE(
      sniff_image({reinterpret_cast<const unsigned char*>(png.data()), png.size()}, small));
}

TEST(ImageHeader, OtherContentIsKeptUnnamed) {
  const auto image = make_image_file("x.tga", {1, 2, 3});
  ASSERT_TRUE(image);
  EXPECT_EQ(image->mime_type, "");
  EXPECT_EQ(image->bytes.size(), 3u);
}

}  // namespace
}  // namespace crosspatch
