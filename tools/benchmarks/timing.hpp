#pragma once

#include <algorithm>
#include <ctime>
#include <vector>

namespace crosspatch {

/// CPU seconds of the process so far, which a busy machine stretches less than those of a clock.
inline double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The middle one, of an even number the upper. Precondition: there is one.
inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace crosspatch
