#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// A decoded picture: values as the file stores them (colour usually sRGB-encoded, alpha not
/// multiplied in), stretched to 16 bits, channel by channel, rows from the top.
struct RasterImage {
  int width = 0;
  int height = 0;
  int channels = 4;                   ///< 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA
  std::vector<std::uint16_t> values;  ///< channels * width * height
};

/// Decodes an image file held in memory (PNG or JPEG, told by its first bytes). kBadInput: another
/// format, broken data, or more than 16384 pixels on a side or 128 million altogether, which is
/// checked before any pixel is read. `most_channels`: of an image that has more, the first ones.
/// Not for use by several threads at once.
Result<RasterImage> decode_image_file(const std::vector<unsigned char>& bytes,
                                      int most_channels = 4);

enum class ImageFormat { kPng, kJpeg, kExr };

/// How an image is stored.
struct ImageEncoding {
  ImageFormat format = ImageFormat::kPng;
  int bits = 8;           ///< 8 or 16; a JPEG has 8, an EXR 16 (half precision)
  bool is_color = true;   ///< the values are sRGB-encoded; an EXR stores them linear
  int jpeg_quality = 95;  ///< 1 to 100. Ours: no visible blocks on fur
  /// 0 to 9: up to 3 is quick, more is small. Measured on textures with 4096 texels a side: 4 takes
  /// more than three times as long as 3 for 12 to 16 % less.
  int png_compression = 3;
};

/// The image as the bytes of a file. JPEG leaves alpha out. kOutput when the encoder fails.
Result<std::vector<unsigned char>> encode_image_file(const RasterImage& image,
                                                     const ImageEncoding& encoding = {});

/// Encoded bytes with the name, extension and type that belong to them.
ImageFile image_file(const std::string& stem, ImageFormat format, std::vector<unsigned char> bytes);

}  // namespace crosspatch
