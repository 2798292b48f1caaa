#pragma once

#include "core/result.hpp"

namespace crosspatch {

/// What the program's exit code tells its caller.
enum class ExitCode {
  kDone = 0,
  kGateFailed = 1,  ///< done, but a quality gate failed
  kUsage = 2,
  kBadInput = 3,
  kNoCorrespondence = 4,
  kInternal = 5,  ///< out of memory, a solver gave up, a result could not be written
};

inline ExitCode exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kBadInput:
      return ExitCode::kBadInput;
    case ErrorCode::kNoCorrespondence:
      return ExitCode::kNoCorrespondence;
    case ErrorCode::kNumerical:
    case ErrorCode::kOutput:
    case ErrorCode::kInternal:
      break;
  }
  return ExitCode::kInternal;
}

}  // namespace crosspatch
