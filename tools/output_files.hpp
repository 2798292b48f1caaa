#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"

namespace crosspatch {

/// A file to be written. The path "-" is standard output.
struct OutputFile {
  std::string path;
  std::string bytes;
};

/// Whether files can be written there, before work is spent on them: each path names a file (new,
/// or one to be replaced) in a folder that exists and may be written to, and no two are the same.
/// kOutput otherwise.
Status check_output_paths(const std::vector<std::string>& paths);

/// Writes all files or, as far as the file system allows, none: each is written beside its place
/// and flushed to the disk; only when all are there are they renamed. A signal to end the program
/// that comes meanwhile is obeyed afterwards. On kOutput nothing is left behind.
Status write_output_files(const std::vector<OutputFile>& files);

}  // namespace crosspatch
