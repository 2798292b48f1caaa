#include "transfer/gltf_load.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>

#include "core/image_header.hpp"
#include "transfer/gltf_checks.hpp"

namespace crosspatch {
namespace {

/// What the parser's callbacks need; handed to them as their user data.
struct Loading {
  const std::filesystem::path& folder;
  const ReadLimits& limits;
  std::map<int, std::vector<unsigned char>>& images;
};

bool file_exists(const std::string& name, void* user) {
  return resolve_inside(static_cast<Loading*>(user)->folder, name).has_value();
}

/// No expansion of `~`, variables or globs.
std::string same_path(const std::string& name, void*) {
  return name;
}

bool read_file(std::vector<unsigned char>* out,
               std::string* error,
               const std::string& name,
               void* user) {
  const Loading& loading = *static_cast<Loading*>(user);
  const auto path = resolve_inside(loading.folder, name);
  auto bytes = path ? read_file_bytes(*path, loading.limits.max_file_bytes)
                    : Result<std::vector<unsigned char>>(tl::unexpected(path.error()));
  if (!bytes) {
    if (error != nullptr) *error += bytes.error().message + "\n";
    return false;
  }
  *out = std::move(*bytes);
  return true;
}

bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

/// Keeps the encoded bytes of an image and looks at its header only.
bool keep_image(tinygltf::Image*,
                const int index,
                std::string* error,
                std::string*,
                int,
                int,
                const unsigned char* bytes,
                int size,
                void* user) {
  Loading& loading = *static_cast<Loading*>(user);
  std::string problem;
  if (bytes == nullptr || size <= 0 ||
      static_cast<std::uint64_t>(size) > loading.limits.max_image_bytes) {
    problem = fmt::format("{} bytes, 1 to {} are read", size, loading.limits.max_image_bytes);
  } else {
    const auto header = sniff_image({bytes, static_cast<std::size_t>(size)}, loading.limits);
    if (!header) problem = header.error().message;
  }
  if (!problem.empty()) {
    if (error != nullptr) *error += fmt::format("image {}: {}\n", index, problem);
    return false;
  }
  loading.images[index].assign(bytes, bytes + size);
  return true;
}

/// The parser's messages on one line of bounded length.
std::string one_line(std::string text) {
  constexpr std::size_t kLongest = 200;
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  if (text.size() > kLongest) text.resize(kLongest);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

}  // namespace

Status load_gltf(std::string_view bytes,
                 const std::filesystem::path& folder,
                 const ReadLimits& limits,
                 tinygltf::Model& model,
                 std::map<int, std::vector<unsigned char>>& images,
                 std::vector<std::string>& notes) {
  const auto chunks = split_gltf(bytes);
  if (!chunks) return tl::unexpected(chunks.error());
  if (Status s = check_gltf_json(*chunks, limits); !s) return s;
  Loading loading{folder, limits, images};
  tinygltf::TinyGLTF parser;
  parser.SetFsCallbacks({file_exists, same_path, read_file, write_nothing, &loading});
  parser.SetImageLoader(keep_image, &loading);
  std::string error, warning;
  const unsigned size = static_cast<unsigned>(bytes.size());
  // With an empty base folder the callbacks see the names as the file writes them.
  const bool ok =
      chunks->is_binary
          ? parser.LoadBinaryFromMemory(&model,
                                        &error,
                                        &warning,
                                        reinterpret_cast<const unsigned char*>(bytes.data()),
                                        size)
          : parser.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, "");
  if (!ok)
    return fail(ErrorCode::kBadInput, one_line(error.empty() ? "the parser gave up" : error));
  if (!warning.empty()) notes.push_back(one_line(warning));
  return {};
}

}  // namespace crosspatch
