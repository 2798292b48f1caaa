#include "transfer/image_codec.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/index.hpp"
#include "transfer/color_space.hpp"

namespace crosspatch {
namespace {

constexpr int kMaxSide = 16384;
constexpr std::int64_t kMaxPixels = 128'000'000;  // 512 MB as RGBA
constexpr int kStrip = 64;  // rows converted at a time: no second image need be held

bool starts_with(const std::vector<unsigned char>& bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(), [](char a, unsigned char b) {
           return static_cast<unsigned char>(a) == b;
         });
}

/// Sends standard error nowhere until it goes out of scope: the PNG library under OpenImageIO
/// prints its complaints there, past every error handler that OpenImageIO lets us set. For serial
/// use only, as it holds for the whole process.
class SilentStandardError {
 public:
  SilentStandardError() : kept_(dup(STDERR_FILENO)) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
  }
  SilentStandardError(const SilentStandardError&) = delete;
  SilentStandardError& operator=(const SilentStandardError&) = delete;
  ~SilentStandardError() {
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }

 private:
  int kept_;
};

/// Error texts of the library may span lines; ours do not.
std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::size_t value_count(int width, int height, int channels) {
  return idx(width) * idx(height) * idx(channels);
}

const char* format_name(ImageFormat format) {
  if (format == ImageFormat::kPng) return "png";
  return format == ImageFormat::kJpeg ? "jpeg" : "exr";
}

std::vector<std::uint8_t> to_8_bits(std::span<const std::uint16_t> values) {
  std::vector<std::uint8_t> narrow(values.size());
  std::transform(values.begin(), values.end(), narrow.begin(), [](std::uint16_t v) {
    return static_cast<std::uint8_t>((v * 255U + 32895U) >> 16U);  // v / 257, rounded
  });
  return narrow;
}

/// Linear light, alpha multiplied in, as EXR has it.
std::vector<float> to_linear(std::span<const std::uint16_t> values,
                             std::size_t channels,
                             bool is_color) {
  const ColorSpace space = is_color ? ColorSpace::kSrgb : ColorSpace::kLinear;
  std::vector<float> linear(values.size());
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const std::size_t k = i % channels;
    const bool alpha = channels % 2 == 0 && k == channels - 1;
    const float value =
        alpha ? static_cast<float>(values[i]) / 65535.0F : to_linear_light(values[i], space);
    const float opacity =
        channels % 2 == 0 ? static_cast<float>(values[i - k + channels - 1]) / 65535.0F : 1;
    linear[i] = alpha ? value : value * opacity;
  }
  return linear;
}

}  // namespace

Result<RasterImage> decode_image_file(const std::vector<unsigned char>& bytes, int most_channels) {
  const bool png = starts_with(bytes, "\x89PNG"), jpeg = starts_with(bytes, "\xff\xd8\xff");
  if (!png && !jpeg) return fail(ErrorCode::kBadInput, "image: neither PNG nor JPEG data");
  const SilentStandardError silent;
  const auto input = OIIO::ImageInput::create(png ? "png" : "jpeg");
  OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
  OIIO::ImageSpec spec, config;
  // Colours of transparent pixels as they are stored, not multiplied by alpha.
  config.attribute("oiio:UnassociatedAlpha", 1);
  if (!input || !input->set_ioproxy(&reader) ||
      !input->open(png ? "memory.png" : "memory.jpg", spec, config))
    return fail(ErrorCode::kBadInput,
                "image: " + first_line(input ? input->geterror() : "no reader"));
  if (spec.width < 1 || spec.height < 1 || spec.width > kMaxSide || spec.height > kMaxSide ||
      std::int64_t{spec.width} * spec.height > kMaxPixels)
    return fail(ErrorCode::kBadInput,
                fmt::format("image: {} x {} pixels, at most {} a side and {} altogether are read",
                            spec.width,
                            spec.height,
                            kMaxSide,
                            kMaxPixels));
  if (spec.nchannels < 1 || spec.nchannels > 4)
    return fail(ErrorCode::kBadInput,
                fmt::format("image: {} channels, 1 to 4 are read", spec.nchannels));
  const int channels = std::min(spec.nchannels, most_channels);
  RasterImage image{spec.width, spec.height, channels, {}};
  const std::size_t count = value_count(spec.width, spec.height, channels);
  image.values.reserve(count + 1);  // one more, as levels of a TexturePyramid have
  image.values.resize(count);
  bool good = true;
  if (spec.format == OIIO::TypeDesc::UINT8) {  // widened here: the library goes through floats
    std::vector<std::uint8_t> narrow(value_count(spec.width, kStrip, channels));
    auto out = image.values.begin();
    for (int y = 0; good && y < spec.height; y += kStrip) {
      const int end = std::min(y + kStrip, spec.height);
      good =
          input->read_scanlines(0, 0, y, end, 0, 0, channels, OIIO::TypeDesc::UINT8, narrow.data());
      const auto values = value_count(spec.width, end - y, channels);
      out = std::transform(narrow.begin(),
                           narrow.begin() + static_cast<std::ptrdiff_t>(values),
                           out,
                           [](std::uint8_t v) { return static_cast<std::uint16_t>(v * 257); });
    }
  } else {
    good = input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT16, image.values.data());
  }
  if (!good) return fail(ErrorCode::kBadInput, "image: " + first_line(input->geterror()));
  return image;
}

Result<std::vector<unsigned char>> encode_image_file(const RasterImage& image,
                                                     const ImageEncoding& encoding) {
  const bool jpeg = encoding.format == ImageFormat::kJpeg;
  const bool exr = encoding.format == ImageFormat::kExr;
  // A JPEG drops alpha: its channels are the first one or three.
  const int channels = jpeg ? image.channels - (image.channels % 2 == 0 ? 1 : 0) : image.channels;
  const bool narrow = jpeg || (!exr && encoding.bits == 8);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput sink(bytes);
  const std::string name = format_name(encoding.format);
  const auto output = OIIO::ImageOutput::create(name);
  const OIIO::TypeDesc stored =
      exr ? OIIO::TypeDesc::HALF : (narrow ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
  OIIO::ImageSpec spec(image.width, image.height, channels, stored);
  if (!exr) spec.attribute("oiio:UnassociatedAlpha", 1);
  if (encoding.is_color && !exr) spec.attribute("oiio:ColorSpace", "sRGB");
  if (jpeg) {
    spec.attribute("Compression", fmt::format("jpeg:{}", encoding.jpeg_quality));
    // Colours at full resolution: halved, they would run over the borders of charts.
    spec.attribute("jpeg:subsampling", "4:4:4");
  }
  if (encoding.format == ImageFormat::kPng) {
    spec.attribute("png:compressionLevel", encoding.png_compression);
    // Differences along rows, of which only runs are looked for: half the time of zlib's level 3.
    constexpr int kSubFilter = 16, kQuickest = 3;  // libpng's PNG_FILTER_SUB
    if (encoding.png_compression <= kQuickest) {
      spec.attribute("compression", "rle");
      spec.attribute("png:filter", kSubFilter);
    }
  }
  if (!output || !output->set_ioproxy(&sink) || !output->open("memory." + name, spec))
    return fail(ErrorCode::kOutput,
                name + ": " + first_line(output ? output->geterror() : "no writer"));
  bool written = true;
  const std::size_t row = value_count(image.width, 1, image.channels);
  for (int y = 0; written && y < image.height; y += kStrip) {
    const int end = std::min(y + kStrip, image.height);
    const std::span values = std::span(image.values).subspan(idx(y) * row, idx(end - y) * row);
    const auto write = [&](const auto& converted, OIIO::TypeDesc type) {
      const auto stride = static_cast<OIIO::stride_t>(idx(image.channels) * sizeof converted[0]);
      written = output->write_scanlines(y, end, 0, type, converted.data(), stride);
    };
    if (exr)
      write(to_linear(values, idx(image.channels), encoding.is_color), OIIO::TypeDesc::FLOAT);
    else if (narrow)
      write(to_8_bits(values), OIIO::TypeDesc::UINT8);
    else
      write(values, OIIO::TypeDesc::UINT16);
  }
  if (!written || !output->close())
    return fail(ErrorCode::kOutput, name + ": " + first_line(output->geterror()));
  return bytes;
}

ImageFile image_file(const std::string& stem,
                     ImageFormat format,
                     std::vector<unsigned char> bytes) {
  ImageFile file;
  file.bytes = std::move(bytes);
  const bool jpeg = format == ImageFormat::kJpeg;
  file.name = stem + (format == ImageFormat::kPng ? ".png" : (jpeg ? ".jpg" : ".exr"));
  if (format != ImageFormat::kExr) file.mime_type = jpeg ? "image/jpeg" : "image/png";
  return file;
}

}  // namespace crosspatch
