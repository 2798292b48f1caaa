#pragma once

#include <string_view>

#include "tools/bitmap.hpp"

namespace crosspatch {

/// A pixel font for labels: digits, signs and capitals (small letters are shown as capitals);
/// other bytes show as a question mark. Cells are 6 x 9 with one free column and two free rows.
constexpr int kFontWidth = 6;
constexpr int kFontHeight = 9;

/// Writes one line of text with its upper left corner at (x, y); every font pixel becomes a square
/// of `scale` pixels. What falls outside the bitmap is left out.
void draw_text(Bitmap& bitmap, int x, int y, std::string_view text, int scale, const Color& color);

}  // namespace crosspatch
