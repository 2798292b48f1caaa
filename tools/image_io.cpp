#include "tools/image_io.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string_view>

namespace crosspatch {
namespace {

using std::size_t;

constexpr int kMaxSide = 16384;
constexpr std::int64_t kMaxPixels = 128'000'000;  // 512 MB as RGBA

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

/// Spreads 1 to 4 channels (grey, grey + alpha, RGB, RGBA) to RGBA.
void spread(const std::vector<std::uint8_t>& in, size_t channels, std::vector<std::uint8_t>& rgba) {
  for (size_t i = 0; i < rgba.size() / 4; ++i) {
    const std::uint8_t* p = &in[i * channels];
    const bool grey = channels < 3;
    for (size_t k = 0; k < 3; ++k) rgba[4 * i + k] = grey ? p[0] : p[k];
    rgba[4 * i + 3] = channels % 2 == 0 ? p[channels - 1] : std::uint8_t{255};
  }
}

}  // namespace

Result<Bitmap> decode_image(const std::vector<unsigned char>& bytes) {
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
  Bitmap bitmap{spec.width, spec.height, {}};
  const size_t pixels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
  const size_t channels = static_cast<size_t>(spec.nchannels);
  std::vector<std::uint8_t> raw(pixels * channels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, raw.data()))
    return fail(ErrorCode::kBadInput, "image: " + first_line(input->geterror()));
  bitmap.rgba.resize(4 * pixels);
  spread(raw, channels, bitmap.rgba);
  return bitmap;
}

Result<std::vector<unsigned char>> encode_png(const Bitmap& bitmap) {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput sink(bytes);
  const auto output = OIIO::ImageOutput::create("png");
  OIIO::ImageSpec spec(bitmap.width, bitmap.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (!output || !output->set_ioproxy(&sink) || !output->open("memory.png", spec))
    return fail(ErrorCode::kOutput,
                "PNG: " + first_line(output ? output->geterror() : "no writer"));
  // A stride of 4 bytes skips alpha.
  if (!output->write_image(OIIO::TypeDesc::UINT8, bitmap.rgba.data(), 4) || !output->close())
    return fail(ErrorCode::kOutput, "PNG: " + first_line(output->geterror()));
  return bytes;
}

}  // namespace crosspatch
