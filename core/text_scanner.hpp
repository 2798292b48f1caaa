#pragma once

#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace crosspatch {

/// A number that takes up the whole of `word`; a leading '+' is allowed, "nan" and "inf" are
/// returned as such.
inline std::optional<double> to_double(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0;
  const auto [end, ec] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  // Out of range is a tiny number written out (zero then) or a huge one; the caller's finiteness
  // check must see the latter.
  if (ec == std::errc::result_out_of_range)
    return word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos
               ? 0.0
               : std::numeric_limits<double>::infinity();
  if (ec != std::errc()) return std::nullopt;
  return value;
}

/// An integer that takes up the whole of `word`.
inline std::optional<long long> to_integer(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  long long value = 0;
  const auto [end, ec] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (ec != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Takes the next word off the front of `text`; words are parted by blanks, tabs and line ends.
/// Empty at the end.
inline std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kBlank = " \t\r\n\v\f";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) {
    text = {};
    return {};
  }
  std::size_t end = text.find_first_of(kBlank, begin);
  if (end == std::string_view::npos) end = text.size();
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

/// `text` without blanks at either end.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n\v\f";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

/// `line` up to a `#` that begins it or follows a blank; "1.#QNAN" is a word.
inline std::string_view without_comment(std::string_view line) {
  for (std::size_t i = line.find('#'); i != std::string_view::npos; i = line.find('#', i + 1))
    if (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t') return line.substr(0, i);
  return line;
}

/// Hands out the lines of a text, numbered from 1. Line ends: \n, \r\n or \r.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// The next line without its end, or nothing at the end of the text.
  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = rest_.substr(0, end);
    if (end == std::string_view::npos) {
      rest_ = {};
    } else {
      const bool two = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
      rest_.remove_prefix(end + (two ? 2 : 1));
    }
    ++number_;
    return line;
  }

  /// The next line that holds a word before any comment, without the comment.
  std::optional<std::string_view> next_meaningful() {
    while (auto line = next()) {
      const std::string_view kept = trimmed(without_comment(*line));
      if (!kept.empty()) return kept;
    }
    return std::nullopt;
  }

  [[nodiscard]] long long number() const { return number_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  long long number_ = 0;
};

}  // namespace crosspatch
