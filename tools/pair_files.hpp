#pragma once

#include <string>

namespace crosspatch {

/// Two surfaces and what a run is told about them.
struct PairFiles {
  std::string source;
  std::string target;
  std::string landmarks;  ///< file of corresponding vertices; empty = none
  std::string map;        ///< file of a map of the two to use; empty = find one
  std::string texture;    ///< what the source wears, see give_texture; empty = its own
};

}  // namespace crosspatch
