#pragma once

#include <string>

#include "core/prepare.hpp"
#include "core/soup.hpp"

namespace crosspatch {

/// A mesh file as it was read, and the mesh made of it.
struct InputMesh {
  PolygonSoup soup;
  PreparedMesh prepared;
};

/// Reads a mesh file. kBadInput with the path in front of the message.
Result<PolygonSoup> read_input_soup(const std::string& path);
Result<InputMesh> read_input(const std::string& path);

/// The error with the path in front of its message, unless that names it already.
Error with_path(const std::string& path, Error error);

/// Reads a small text file (landmarks, maps). kBadInput with the path in the message.
Result<std::string> read_input_text(const std::string& path);

}  // namespace crosspatch
