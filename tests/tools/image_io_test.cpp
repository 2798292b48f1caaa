#include "tools/image_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace crosspatch {
namespace {

using Bytes = std::vector<unsigned char>;

void append_be32(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<unsigned char>(value >> shift & 255));
}

std::uint32_t crc32(const Bytes& bytes, std::size_t begin) {
  std::uint32_t crc = 0xffffffff;
  for (std::size_t i = begin; i < bytes.size(); ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc;
}

/// A PNG file that announces a size and ends after its header.
Bytes png_header(std::uint32_t width, std::uint32_t height) {
  Bytes bytes = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13};
  const std::size_t chunk = bytes.size();
  for (const char c : std::string("IHDR")) bytes.push_back(static_cast<unsigned char>(c));
  append_be32(bytes, width);
  append_be32(bytes, height);
  bytes.insert(bytes.end(), {8, 2, 0, 0, 0});
  append_be32(bytes, crc32(bytes, chunk));
  append_be32(bytes, 0);  // an empty IDAT chunk, so that the header is taken as complete
  const std::size_t data = bytes.size();
  for (const char c : std::string("IDAT")) bytes.push_back(static_cast<unsigned char>(c));
  append_be32(bytes, crc32(bytes, data));
  return bytes;
}

TEST(ImageIo, PngReadsBackEqual) {
  Bitmap bitmap = make_bitmap(5, 3, Color::Zero());
  for (std::size_t i = 0; i < bitmap.rgba.size(); ++i)
    bitmap.rgba[i] = i % 4 == 3 ? std::uint8_t{255} : static_cast<std::uint8_t>(37 * i % 256);
  const auto bytes = encode_png(bitmap);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto decoded = decode_image(*bytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->width, 5);
  EXPECT_EQ(decoded->height, 3);
  EXPECT_EQ(decoded->rgba, bitmap.rgba);
}

TEST(ImageIo, HugeImagesAreRefusedBeforeTheirPixels) {
  const auto bomb = decode_image(png_header(60000, 60000));
  ASSERT_FALSE(bomb);
  EXPECT_THAT(bomb.error().message, testing::HasSubstr("60000 x 60000 pixels"));
  EXPECT_EQ(bomb.error().code, ErrorCode::kBadInput);
}

TEST(ImageIo, BrokenDataIsBadInputOnOneLine) {
  Bytes truncated = encode_png(make_bitmap(40, 40, Color(1, 0.5, 0))).value();
  truncated.resize(truncated.size() / 2);
  for (const Bytes& bytes : {Bytes{},
                             Bytes{'G', 'I', 'F', '8'},
                             Bytes{0x89, 'P', 'N', 'G'},
                             Bytes{0xff, 0xd8, 0xff, 0, 1, 2},
                             png_header(8, 8),
                             truncated}) {
    const auto image = decode_image(bytes);
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(image.error().message, testing::StartsWith("image: "));
    EXPECT_EQ(image.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace crosspatch
