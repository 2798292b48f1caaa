#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tools/bitmap.hpp"
#include "tools/image_io.hpp"

namespace crosspatch::test {

/// How different two pictures look.
struct Difference {
  double mean = 0;   ///< over all pixels, in 8-bit levels of the worst channel
  double worst = 0;  ///< of the worst pixel
};

/// Both pictures are blurred over 3 x 3 pixels first: a change of rounding moves single samples of
/// an edge, which no eye sees; a thing that is moved, missing or of another colour stays visible.
inline Difference difference(const Bitmap& a, const Bitmap& b) {
  if (a.width != b.width || a.height != b.height) return {255, 255};
  const auto blurred = [](const Bitmap& bitmap, int x, int y, int channel) {
    double sum = 0, count = 0;
    for (int j = std::max(0, y - 1); j <= std::min(bitmap.height - 1, y + 1); ++j)
      for (int i = std::max(0, x - 1); i <= std::min(bitmap.width - 1, x + 1); ++i, ++count)
        sum += bitmap.rgba[static_cast<std::size_t>(4 * (j * bitmap.width + i) + channel)];
    return sum / count;
  };
  Difference result;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      double levels = 0;
      for (int channel = 0; channel < 3; ++channel)
        levels = std::max(levels, std::abs(blurred(a, x, y, channel) - blurred(b, x, y, channel)));
      result.mean += levels / (a.width * a.height);
      result.worst = std::max(result.worst, levels);
    }
  return result;
}

inline std::vector<unsigned char> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The difference to the stored picture of that name. With CROSSPATCH_STORE_PICTURES set in the
/// environment the picture is stored instead, to be looked at and committed.
inline Difference difference_to_stored(const Bitmap& picture, const std::string& name) {
  const std::string path = std::string(CROSSPATCH_TESTS) + "/tools/expected/" + name + ".png";
  if (std::getenv("CROSSPATCH_STORE_PICTURES") != nullptr) {
    const auto bytes = encode_png(picture).value();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    return {};
  }
  const Result<Bitmap> stored = decode_image(read_bytes(path));
  return stored ? difference(picture, *stored) : Difference{255, 255};
}

}  // namespace crosspatch::test
