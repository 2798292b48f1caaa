#pragma once

#include <string_view>
#include <vector>

namespace crosspatch {

/// A line that says something: its words, and its number in the file from 1.
struct TextLine {
  int number = 0;
  std::vector<std::string_view> words;  ///< into the text
};

/// The lines of a text cut into words at blanks and commas; what follows a `#` and empty lines are
/// left out.
std::vector<TextLine> text_lines(std::string_view text);

/// Whether the whole word is a number of the type; only then `value` is set.
bool parse_number(std::string_view word, int& value);
bool parse_number(std::string_view word, double& value);

}  // namespace crosspatch
