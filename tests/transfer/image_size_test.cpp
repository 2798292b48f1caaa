#include "transfer/image_size.hpp"

#include <gtest/gtest.h>

#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

TEST(ImageSize, PngHeaderIsRead) {
  const auto size = image_size(shapes::png_header(640, 480));
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 640);
  EXPECT_EQ(size->height, 480);
}

TEST(ImageSize, JpegFrameHeaderIsFoundBehindOtherSegments) {
  // SOI, APP0 of 4 bytes, DHT (0xc4, not a frame) of 3 bytes, SOF2 with 300 lines of 500 samples.
  const ImageFile jpeg{
      "a.jpg", "image/jpeg", {0xff,     0xd8,      0xff,     0xe0,      0,    4,    1,    2,  0xff,
                              0xc4,     0,         3,        9,         0xff, 0xc2, 0,    11, 8,
                              300 >> 8, 300 & 255, 500 >> 8, 500 & 255, 1,    1,    0x11, 0}};
  const auto size = image_size(jpeg);
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 500);
  EXPECT_EQ(size->height, 300);
}

TEST(ImageSize, EveryCutOfAHeaderIsSafe) {
  ImageFile image = shapes::png_header(640, 480);
  while (!image.bytes.empty()) {
    image.bytes.pop_back();
    EXPECT_FALSE(image_size(image));
  }
  EXPECT_FALSE(image_size({"x", "", {0xff, 0xd8, 0xff, 0xe0, 0, 0, 0, 0, 0, 0, 0, 0}}));
}

}  // namespace
}  // namespace crosspatch
