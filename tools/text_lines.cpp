#include "tools/text_lines.hpp"

#include <charconv>

namespace crosspatch {
namespace {

template <class Number>
bool parse_whole(std::string_view word, Number& value) {
  Number parsed{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), parsed);
  if (error != std::errc{} || end != word.data() + word.size()) return false;
  value = parsed;
  return true;
}

}  // namespace

std::vector<TextLine> text_lines(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r,";
  std::vector<TextLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(line.size() < text.size() ? line.size() + 1 : line.size());
    line = line.substr(0, line.find('#'));
    TextLine result{number, {}};
    for (std::size_t begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;
         begin = line.find_first_not_of(kBlanks, begin)) {
      const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
      result.words.push_back(line.substr(begin, end - begin));
      begin = end;
    }
    if (!result.words.empty()) lines.push_back(std::move(result));
  }
  return lines;
}

bool parse_number(std::string_view word, int& value) {
  return parse_whole(word, value);
}
bool parse_number(std::string_view word, double& value) {
  return parse_whole(word, value);
}

}  // namespace crosspatch
