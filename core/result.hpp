#pragma once

#include <string>
#include <tl/expected.hpp>

namespace crosspatch {

/// What kind of thing went wrong; the command line maps each to an exit code.
enum class ErrorCode {
  kBadInput,          ///< a file or an option's value cannot be used
  kNoCorrespondence,  ///< no trustworthy correspondence exists or was found
  kNumerical,         ///< a solver did not reach a usable answer
  kOutput,            ///< a result cannot be written
  kInternal,          ///< a promise of our own code was broken
};

/// `message` names the thing, its value and the bound it broke, on one line.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace crosspatch
