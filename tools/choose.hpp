#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace crosspatch {

/// Sets `value` to what the word stands for; otherwise says what it may be.
template <class T>
std::string choose(const std::string& word,
                   const std::vector<std::pair<std::string, T>>& choices,
                   const char* option,
                   T& value) {
  std::string names;
  for (const auto& [name, choice] : choices) {
    if (word == name) {
      value = choice;
      return "";
    }
    names += (names.empty() ? "" : ", ") + name;
  }
  return fmt::format("{}: '{}' is none of {}", option, word, names);
}

}  // namespace crosspatch
