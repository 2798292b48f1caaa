#pragma once

#include <string>

#include "tools/pipeline.hpp"
#include "tools/report.hpp"

namespace crosspatch {

/// The page of a run over a pair that has a map: one HTML file that works from disk and asks for
/// nothing else. It shows both surfaces with linked cameras, what leads from one to the other, the
/// figures of `report` with what they mean, and the first alternative map. kOutput in a build
/// without the viewer; errors of the stages it draws.
Result<std::string> pair_page(const PairRun& run, const RunReport& report);

}  // namespace crosspatch
