#pragma once

#include <cstddef>

namespace crosspatch {

/// A mesh index as a container index.
inline std::size_t idx(int i) {
  return static_cast<std::size_t>(i);
}
inline std::size_t idx(long i) {
  return static_cast<std::size_t>(i);
}

}  // namespace crosspatch
