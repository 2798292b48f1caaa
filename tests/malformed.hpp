#pragma once

#include <string>
#include <utility>
#include <vector>

namespace crosspatch::files {

/// A file no reader should trust, and what must come of it.
struct Malformed {
  std::string name;   ///< of the case
  std::string file;   ///< name of the file to read, its extension chooses the reader
  std::string bytes;  ///< its content
  /// Part of the error's message; or, where `repaired`, of one of the repairs.
  std::string says;
  bool repaired = false;
};

/// Malformed OBJ, OFF, PLY, STL and glTF files: cut short, zeros, NaN, huge and negative counts,
/// indices out of range, path traversal, deep JSON, image bombs, overlapping lies about lengths.
std::vector<Malformed> malformed_files();

/// Sound files of every format, to be cut or changed at random: file name, content.
std::vector<std::pair<std::string, std::string>> sound_files();

}  // namespace crosspatch::files
