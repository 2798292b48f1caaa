#include "transfer/image_size.hpp"

#include <algorithm>
#include <array>

namespace crosspatch {
namespace {

using Bytes = std::vector<unsigned char>;

int big_endian(const Bytes& b, std::size_t at, std::size_t count) {
  unsigned value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8U | b[at + i];
  return static_cast<int>(value & 0x7fffffffU);
}

std::optional<ImageSize> positive(int width, int height) {
  if (width <= 0 || height <= 0) return std::nullopt;
  return ImageSize{width, height};
}

// ISO/IEC 15948, 11.2.2: the signature is followed by the IHDR chunk.
std::optional<ImageSize> png_size(const Bytes& b) {
  constexpr std::array<unsigned char, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (b.size() < 24 || !std::equal(kSignature.begin(), kSignature.end(), b.begin()))
    return std::nullopt;
  return positive(big_endian(b, 16, 4), big_endian(b, 20, 4));
}

// ITU-T T.81, B.2.2: walk the marker segments to the first frame header (SOF0 .. SOF15, of which
// DHT, JPG and DAC are none).
std::optional<ImageSize> jpeg_size(const Bytes& b) {
  if (b.size() < 4 || b[0] != 0xff || b[1] != 0xd8) return std::nullopt;
  std::size_t i = 2;
  while (i + 9 <= b.size()) {
    if (b[i] != 0xff) return std::nullopt;
    const unsigned marker = b[i + 1];
    if (marker == 0xff) {  // fill byte
      ++i;
      continue;
    }
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc)
      return positive(big_endian(b, i + 7, 2), big_endian(b, i + 5, 2));
    const auto length = static_cast<std::size_t>(big_endian(b, i + 2, 2));
    if (length < 2) return std::nullopt;
    i += 2 + length;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ImageSize> image_size(const ImageFile& image) {
  if (const auto size = png_size(image.bytes)) return size;
  return jpeg_size(image.bytes);
}

}  // namespace crosspatch
