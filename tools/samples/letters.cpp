#include "tools/samples/letters.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <tuple>

#include "core/types.hpp"
#include "tools/font.hpp"

namespace crosspatch {
namespace {

/// A side of the box: `right` and `up` as one sees it from outside.
struct Side {
  char letter;
  Vector3d outwards, right, up;
  Color color;
};

const std::array<Side, 6>& sides() {
  static const std::array<Side, 6> all{{
      {'F', {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0.8F, 0.05F, 0.05F}},
      {'B', {0, 0, -1}, {-1, 0, 0}, {0, 1, 0}, {0.05F, 0.5F, 0.05F}},
      {'L', {1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0.05F, 0.1F, 0.8F}},
      {'R', {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0.7F, 0.5F, 0.02F}},
      {'U', {0, 1, 0}, {1, 0, 0}, {0, 0, -1}, {0.02F, 0.5F, 0.6F}},
      {'D', {0, -1, 0}, {1, 0, 0}, {0, 0, 1}, {0.6F, 0.05F, 0.6F}},
  }};
  return all;
}

constexpr int kColumns = 2, kRows = 3;
constexpr int kWidth = 256, kHeight = 171;  // of a side in the image; 512 x 513 altogether
constexpr int kQuads = 4;                   // a side has 4 x 4
const Vector3d kHalfSize(1.2, 0.8, 1);      // three different lengths

void fill(Bitmap& bitmap, int x, int y, int width, int height, const Color& color) {
  for (int j = y; j < y + height; ++j)
    for (int i = x; i < x + width; ++i) set_pixel(bitmap, i, j, color);
}

Bitmap paint() {
  const Color white = Color::Ones(), black = Color::Zero();
  Bitmap image = make_bitmap(kColumns * kWidth, kRows * kHeight, black);
  for (int i = 0; i < 6; ++i) {
    const Side& side = sides()[static_cast<std::size_t>(i)];
    const int x = i % kColumns * kWidth, y = i / kColumns * kHeight;
    constexpr int kScale = 18;  // a letter of 90 x 126
    fill(image, x, y, kWidth, kHeight, side.color);
    draw_text(image, x + 84, y + 4, std::string(1, side.letter), kScale, white);
    fill(image, x + 16, y + 16, 32, 32, white);
    fill(image, x + kWidth - 48, y + kHeight - 48, 32, 32, black);
  }
  return image;
}

/// The box's points by place, so that sides share those on their edges.
class Grid {
 public:
  int vertex(const Side& side, int i, int j) {
    const Vector3d unit =
        side.outwards + (2.0 * i / kQuads - 1) * side.right + (2.0 * j / kQuads - 1) * side.up;
    const auto key = std::make_tuple(unit[0], unit[1], unit[2]);
    const auto [entry, fresh] = number_.try_emplace(key, static_cast<int>(number_.size()) + 1);
    const Vector3d place = unit.cwiseProduct(kHalfSize);
    if (fresh) lines_ += fmt::format("v {:.4f} {:.4f} {:.4f}\n", place[0], place[1], place[2]);
    return entry->second;
  }
  [[nodiscard]] const std::string& lines() const { return lines_; }

 private:
  std::map<std::tuple<double, double, double>, int> number_;
  std::string lines_;
};

}  // namespace

LetterBox make_letter_box() {
  Grid grid;
  std::string coordinates, faces;
  for (int s = 0; s < 6; ++s) {
    const Side& side = sides()[static_cast<std::size_t>(s)];
    constexpr int kPoints = kQuads + 1;
    const auto corner = [&](int i, int j) {
      const int vt = s * kPoints * kPoints + j * kPoints + i + 1;
      return fmt::format(" {}/{}", grid.vertex(side, i, j), vt);
    };
    for (int j = 0; j < kPoints; ++j)
      for (int i = 0; i < kPoints; ++i)
        // OBJ's v runs upwards.
        coordinates += fmt::format("vt {:.6f} {:.6f}\n",
                                   (s % kColumns + double(i) / kQuads) / kColumns,
                                   1 - (s / kColumns + 1 - double(j) / kQuads) / kRows);
    for (int j = 0; j < kQuads; ++j)
      for (int i = 0; i < kQuads; ++i) {
        const std::string a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1),
                          d = corner(i, j + 1);
        faces += "f" + a + b + c + "\nf" + a + c + d + "\n";
      }
  }
  return {"# made by crosspatch's make_samples\nmtllib letters.mtl\n" + grid.lines() + coordinates +
              "usemtl letters\n" + faces,
          paint()};
}

}  // namespace crosspatch
