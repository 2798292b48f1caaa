#include "tools/input.hpp"

#include "core/file_bytes.hpp"
#include "core/read_soup.hpp"

namespace crosspatch {
namespace {

/// `message` with the path in front, unless it is named already.
Error named(const std::string& path, Error error) {
  if (error.message.find(path) == std::string::npos) error.message = path + ": " + error.message;
  return error;
}

}  // namespace

Result<PolygonSoup> read_input_soup(const std::string& path) {
  return read_soup(path).map_error([&](const Error& e) { return named(path, e); });
}

Result<InputMesh> read_input(const std::string& path) {
  Result<PolygonSoup> soup = read_input_soup(path);
  if (!soup) return tl::unexpected(soup.error());
  Result<PreparedMesh> prepared = prepare(*soup);
  if (!prepared) return tl::unexpected(named(path, prepared.error()));
  return InputMesh{std::move(*soup), std::move(*prepared)};
}

Result<std::string> read_input_text(const std::string& path) {
  const auto bytes = read_file_bytes(path, ReadLimits{}.max_file_bytes);
  if (!bytes) return tl::unexpected(named(path, bytes.error()));
  return std::string(bytes->begin(), bytes->end());
}

}  // namespace crosspatch
