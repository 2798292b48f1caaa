#pragma once

#include <map>
#include <string>
#include <vector>

namespace crosspatch {

/// A figure of a run in words.
struct FigureVerdict {
  std::string name;
  std::string value;
  std::string level;  ///< "good", "fair" or "poor"
  std::string text;   ///< what it means for the reader
};

/// The figures of RunReport::quality that a person asks for first, most important first; those
/// that are absent are left out.
std::vector<FigureVerdict> verdicts(const std::map<std::string, double>& quality);

}  // namespace crosspatch
