#include "tools/image_io.hpp"

#include <algorithm>
#include <cstdint>

#include "transfer/image_codec.hpp"

namespace crosspatch {

using std::size_t;

Result<Bitmap> decode_image(const std::vector<unsigned char>& bytes) {
  const Result<RasterImage> image = decode_image_file(bytes);
  if (!image) return tl::unexpected(image.error());
  Bitmap bitmap{image->width, image->height, {}};
  const size_t channels = static_cast<size_t>(image->channels);
  bitmap.rgba.resize(4 * image->values.size() / channels);
  const auto narrow = [](std::uint16_t v) { return static_cast<std::uint8_t>(v >> 8); };
  for (size_t i = 0; i < bitmap.rgba.size() / 4; ++i) {
    const std::uint16_t* p = &image->values[i * channels];
    for (size_t k = 0; k < 3; ++k) bitmap.rgba[4 * i + k] = narrow(p[channels < 3 ? 0 : k]);
    bitmap.rgba[4 * i + 3] = channels % 2 == 0 ? narrow(p[channels - 1]) : std::uint8_t{255};
  }
  return bitmap;
}

Result<std::vector<unsigned char>> encode_png(const Bitmap& bitmap) {
  RasterImage image{bitmap.width, bitmap.height, 3, {}};
  image.values.reserve(bitmap.rgba.size() / 4 * 3);
  for (size_t i = 0; i < bitmap.rgba.size(); ++i)
    if (i % 4 != 3) image.values.push_back(static_cast<std::uint16_t>(bitmap.rgba[i] * 257));
  return encode_image_file(image, {.png_compression = 4});  // drawings: small
}

}  // namespace crosspatch
