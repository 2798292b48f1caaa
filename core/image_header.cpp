// PNG: ISO/IEC 15948, section 11.2.2 (IHDR comes first). JPEG: ITU-T T.81, annex B (SOFn marker).
#include "core/image_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace crosspatch {
namespace {

using Bytes = std::span<const unsigned char>;

constexpr std::array<unsigned char, 8> kPngMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

bool is_png(Bytes bytes) {
  return bytes.size() >= kPngMagic.size() &&
         std::equal(kPngMagic.begin(), kPngMagic.end(), bytes.begin());
}

bool is_jpeg(Bytes bytes) {
  return bytes.size() >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff;
}

std::int64_t big_endian(Bytes bytes) {
  std::int64_t value = 0;
  for (const unsigned char b : bytes) value = value * 256 + b;
  return value;
}

Result<ImageHeader> checked(std::int64_t width,
                            std::int64_t height,
                            const char* mime,
                            const ReadLimits& limits) {
  if (width < 1 || height < 1 || width > limits.max_image_side || height > limits.max_image_side ||
      width * height > limits.max_image_texels)
    return fail(ErrorCode::kBadInput,
                fmt::format("image of {} x {} texels: sides must be 1 to {}, the area at most {}",
                            width,
                            height,
                            limits.max_image_side,
                            limits.max_image_texels));
  return ImageHeader{static_cast<int>(width), static_cast<int>(height), mime};
}

Result<ImageHeader> sniff_png(Bytes bytes, const ReadLimits& limits) {
  constexpr std::size_t kHeaderEnd = 8 + 4 + 4 + 13;
  if (bytes.size() < kHeaderEnd) return fail(ErrorCode::kBadInput, "PNG image: header cut short");
  if (big_endian(bytes.subspan(8, 4)) != 13 || big_endian(bytes.subspan(12, 4)) != 0x49484452)
    return fail(ErrorCode::kBadInput, "PNG image: does not begin with an IHDR chunk");
  return checked(
      big_endian(bytes.subspan(16, 4)), big_endian(bytes.subspan(20, 4)), "image/png", limits);
}

bool is_frame_header(unsigned char marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

Result<ImageHeader> sniff_jpeg(Bytes bytes, const ReadLimits& limits) {
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && bytes[at] == 0xff) {
    const unsigned char marker = bytes[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0xda || marker == 0xd9) break;  // pixels or the end before any frame header
    const std::size_t length = static_cast<std::size_t>(big_endian(bytes.subspan(at + 2, 2)));
    if (length < 2 || at + 2 + length > bytes.size()) break;
    if (is_frame_header(marker)) {
      if (length < 7) break;
      return checked(big_endian(bytes.subspan(at + 7, 2)),
                     big_endian(bytes.subspan(at + 5, 2)),
                     "image/jpeg",
                     limits);
    }
    at += 2 + length;
  }
  return fail(ErrorCode::kBadInput, "JPEG image: no frame header before the pixels");
}

}  // namespace

Result<ImageHeader> sniff_image(Bytes bytes, const ReadLimits& limits) {
  if (is_png(bytes)) return sniff_png(bytes, limits);
  if (is_jpeg(bytes)) return sniff_jpeg(bytes, limits);
  return fail(ErrorCode::kBadInput, "image: neither PNG nor JPEG");
}

Result<ImageFile> make_image_file(std::string name,
                                  std::vector<unsigned char> bytes,
                                  const ReadLimits& limits) {
  ImageFile image{std::move(name), "", std::move(bytes)};
  if (!is_png(image.bytes) && !is_jpeg(image.bytes)) return image;
  auto size = sniff_image(image.bytes, limits);
  if (!size)
    return fail(ErrorCode::kBadInput,
                fmt::format("image {}: {}", in_quotes(image.name), size.error().message));
  image.mime_type = std::move(size->mime_type);
  return image;
}

}  // namespace crosspatch
