#include "transfer/read_mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

#include "core/read_soup.hpp"
#include "transfer/gltf_read.hpp"

namespace crosspatch {

Result<PolygonSoup> read_mesh_file(const std::filesystem::path& path, const ReadLimits& limits) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  std::array<char, 4> magic{};
  std::error_code ec;
  if (std::filesystem::is_regular_file(path, ec))
    std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
  const bool is_glb = magic == std::array{'g', 'l', 'T', 'F'};
  if (is_glb || extension == ".gltf" || extension == ".glb") return read_gltf(path, limits);
  return read_soup(path, limits);
}

}  // namespace crosspatch
