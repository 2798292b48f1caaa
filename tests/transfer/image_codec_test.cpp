#include "transfer/image_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "core/index.hpp"
#include "temp_folder.hpp"

namespace crosspatch {
namespace {

RasterImage image(int width, int height, int channels, std::vector<std::uint16_t> values) {
  return {width, height, channels, std::move(values)};
}

/// What OpenImageIO's own tool prints of the file: a line about it, then a value a channel and
/// pixel, row by row, in [0, 1], colour multiplied by alpha.
struct Outside {
  std::string description;
  std::vector<double> values;
};

Outside read_outside(const std::vector<unsigned char>& bytes, const std::string& name) {
  const TempFolder folder;
  const auto file = folder.write(name, std::string(bytes.begin(), bytes.end()));
  Outside outside;
  FILE* pipe = popen(("oiiotool --info -v --dumpdata " + file.string() + " 2>&1").c_str(), "r");
  EXPECT_NE(pipe, nullptr);
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0) << text;
  for (std::size_t line = 0; line < text.size(); line = text.find('\n', line) + 1) {
    const std::size_t end = text.find('\n', line);
    std::string row = text.substr(line, end - line);
    if (const std::size_t at = row.find("Pixel ("); at != std::string::npos) {
      row = row.substr(row.find("):", at) + 2);
      row = row.substr(0, row.find('('));  // integers, then the same as shares in brackets
      for (std::size_t used = 0; row.find_first_not_of(' ') != std::string::npos;
           row = row.substr(used))
        outside.values.push_back(std::stod(row, &used));
    } else if (outside.values.empty()) {
      outside.description += row + '\n';
    }
    if (end == std::string::npos) break;
  }
  return outside;
}

TEST(ImageCodec, PngKeepsEveryValueOfBothDepths) {
  RasterImage fine = image(3, 2, 3, {});
  for (std::uint32_t i = 0; i < 18; ++i)
    fine.values.push_back(static_cast<std::uint16_t>(i * 3641));
  const auto wide = encode_image_file(fine, {.bits = 16});
  ASSERT_TRUE(wide);
  EXPECT_EQ(decode_image_file(*wide)->values, fine.values);
  const Outside outside = read_outside(*wide, "a.png");
  EXPECT_NE(outside.description.find("3 channel, uint16 png"), std::string::npos)
      << outside.description;
  ASSERT_EQ(outside.values.size(), fine.values.size()) << outside.description;
  for (std::size_t i = 0; i < fine.values.size(); ++i)
    EXPECT_EQ(outside.values[i], fine.values[i]) << i;

  for (std::uint16_t& v : fine.values) v = static_cast<std::uint16_t>(v / 257 * 257);
  const auto narrow = encode_image_file(fine, {.bits = 8});
  EXPECT_EQ(decode_image_file(*narrow)->values, fine.values);
  EXPECT_NE(read_outside(*narrow, "a.png").description.find("3 channel, uint8 png"),
            std::string::npos);
}

TEST(ImageCodec, PngKeepsTheColourOfTransparentPixels) {
  const RasterImage clear = image(2, 1, 4, {65535, 25700, 0, 0, 257, 514, 771, 32896});
  EXPECT_EQ(decode_image_file(*encode_image_file(clear, {.bits = 16}))->values, clear.values);
}

TEST(ImageCodec, ExrIsLinearHalfPrecisionTimesAlpha) {
  // sRGB 188 of 255 is 0.5029 of linear light by IEC 61966-2-1: ((188 / 255 + 0.055) / 1.055)^2.4.
  const double light = std::pow((188.0 / 255 + 0.055) / 1.055, 2.4);
  const RasterImage grey =
      image(2, 1, 4, {188 * 257, 0, 65535, 65535, 188 * 257, 0, 65535, 13107});  // alpha 1, 0.2
  const Outside color =
      read_outside(*encode_image_file(grey, {.format = ImageFormat::kExr}), "a.exr");
  EXPECT_NE(color.description.find("4 channel, half openexr"), std::string::npos)
      << color.description;
  const std::vector<double> expected{light, 0, 1, 1, light / 5, 0, 0.2, 0.2};
  ASSERT_EQ(color.values.size(), expected.size()) << color.description;
  constexpr double kHalf = 1.0 / 2048;  // relative rounding of half precision
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(color.values[i], expected[i], kHalf * expected[i]) << i;

  const Outside data =
      read_outside(*encode_image_file(image(1, 1, 3, {188 * 257, 0, 65535}),
                                      {.format = ImageFormat::kExr, .is_color = false}),
                   "b.exr");
  ASSERT_EQ(data.values.size(), 3U);
  EXPECT_NEAR(data.values[0], 188.0 / 255, kHalf);
}

TEST(ImageCodec, JpegHasColourAtFullResolutionAndNoAlpha) {
  // Red and green meet inside of a block, at an odd column.
  RasterImage sharp = image(16, 16, 4, {});
  for (int i = 0; i < 256; ++i) {
    const bool left = i % 16 < 7;
    for (const int v : {left ? 200 : 60, left ? 60 : 200, 60, 128})
      sharp.values.push_back(static_cast<std::uint16_t>(v * 257));
  }
  const auto bytes = encode_image_file(sharp, {.format = ImageFormat::kJpeg, .jpeg_quality = 95});
  ASSERT_TRUE(bytes);
  const auto back = decode_image_file(*bytes);
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->channels, 3);
  const Outside outside = read_outside(*bytes, "a.jpg");
  EXPECT_NE(outside.description.find("3 channel, uint8 jpeg"), std::string::npos);
  ASSERT_EQ(outside.values.size(), back->values.size());
  for (std::size_t i = 0; i < back->values.size(); ++i) {
    EXPECT_EQ(outside.values[i] * 257, back->values[i]) << i;
    // Quantisation at this quality; halved colour would be off by half the step, 70, at the border.
    EXPECT_NEAR(back->values[i], sharp.values[i / 3 * 4 + i % 3], 12 * 257) << i;
  }
}

TEST(ImageCodec, HighImagesComeBackWhole) {
  // More rows than are converted at a time, and no multiple of that.
  RasterImage high = image(3, 150, 4, {});
  for (int i = 0; i < 3 * 150 * 4; ++i)
    high.values.push_back(static_cast<std::uint16_t>(i * 37 % 256 * 257));
  for (const int bits : {8, 16})
    for (const int compression : {1, 6}) {
      const auto bytes = encode_image_file(high, {.bits = bits, .png_compression = compression});
      ASSERT_TRUE(bytes) << bytes.error().message;
      const auto back = decode_image_file(*bytes);
      ASSERT_TRUE(back) << back.error().message;
      EXPECT_EQ(back->values, high.values) << bits << ' ' << compression;
    }
}

TEST(ImageCodec, FurtherChannelsAreLeftOut) {
  const RasterImage four = image(2, 1, 4, {257, 514, 771, 1028, 1285, 1542, 1799, 2056});
  for (const int bits : {8, 16}) {
    const auto back = decode_image_file(*encode_image_file(four, {.bits = bits}), 3);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->channels, 3);
    EXPECT_EQ(back->values, (std::vector<std::uint16_t>{257, 514, 771, 1285, 1542, 1799}));
  }
}

TEST(ImageCodec, OtherFormatsAreRefused) {
  const auto exr = encode_image_file(image(1, 1, 3, {0, 0, 0}), {.format = ImageFormat::kExr});
  const auto read = decode_image_file(*exr);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message, "image: neither PNG nor JPEG data");
}

}  // namespace
}  // namespace crosspatch
