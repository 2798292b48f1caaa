#pragma once

#include <string>

namespace crosspatch {

/// Two surfaces and what a run over them is told.
struct PairFiles {
  std::string source;
  std::string target;
  std::string landmarks;  ///< file of corresponding vertices; empty = none
  std::string map;        ///< file of a map of the two to use; empty = find one
  int map_base = 0;       ///< what that file counts from, 0 or 1; overlays count from 0
  int alternatives = 0;   ///< other maps to be made, at most
  bool force = false;     ///< whether to go on with a map that cannot be trusted, see kMostEnergy
  std::string texture;    ///< what the source wears, see give_texture; empty = its own
};

}  // namespace crosspatch
