# Writes HEADER with the commit of the sources in SOURCE, if it is not what HEADER says already.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#pragma once

namespace crosspatch {

inline constexpr const char* kBenchmarkCommit = \"@commit@\";

}  // namespace crosspatch
" @ONLY)
