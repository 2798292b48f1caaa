#pragma once

#include <string>

#include "tools/bitmap.hpp"

namespace crosspatch {

/// A box with a letter on each side, to tell which way round a texture is: F in front (+z), B at
/// the back, L on its left (+x), R on its right, U on top, D below. Seen from outside every letter
/// stands upright where +y is up, U where the front is at the lower rim and D where it is at the
/// upper one; a white square is at its upper left, a black one at its lower right.
struct LetterBox {
  std::string obj;  ///< names the material file `letters.mtl`
  Bitmap image;     ///< two columns by three rows of sides, in the order F B, L R, U D
};

LetterBox make_letter_box();

}  // namespace crosspatch
