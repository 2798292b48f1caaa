#include "tools/input.hpp"

#include "core/file_bytes.hpp"
#include "transfer/read_mesh_file.hpp"

namespace crosspatch {

Error with_path(const std::string& path, Error error) {
  if (error.message.find(path) == std::string::npos) error.message = path + ": " + error.message;
  return error;
}

Result<PolygonSoup> read_input_soup(const std::string& path) {
  return read_mesh_file(path).map_error([&](const Error& e) { return with_path(path, e); });
}

Result<InputMesh> read_input(const std::string& path) {
  Result<PolygonSoup> soup = read_input_soup(path);
  if (!soup) return tl::unexpected(soup.error());
  Result<PreparedMesh> prepared = prepare(*soup);
  if (!prepared) return tl::unexpected(with_path(path, prepared.error()));
  return InputMesh{std::move(*soup), std::move(*prepared)};
}

Result<std::string> read_input_text(const std::string& path) {
  const auto bytes = read_file_bytes(path, ReadLimits{}.max_file_bytes);
  if (!bytes) return tl::unexpected(with_path(path, bytes.error()));
  return std::string(bytes->begin(), bytes->end());
}

}  // namespace crosspatch
