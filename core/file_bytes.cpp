#include "core/file_bytes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace crosspatch {
namespace {

namespace fs = std::filesystem;

bool is_inside(const fs::path& folder, const fs::path& file) {
  const auto [end, unused] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end == folder.end();
}

}  // namespace

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown(text.substr(0, kLongest));
  for (char& c : shown)
    if (c < 0x20 || c == 0x7f) c = '?';
  return "'" + shown + (text.size() > kLongest ? "...'" : "'");
}

Result<std::vector<unsigned char>> read_file_bytes(const fs::path& path, std::uint64_t max_bytes) {
  const std::string name = in_quotes(path.filename().string());
  std::error_code ec;
  if (!fs::exists(path, ec)) return fail(ErrorCode::kBadInput, name + ": no such file");
  if (!fs::is_regular_file(path, ec))
    return fail(ErrorCode::kBadInput, name + ": not a regular file");
  const std::uint64_t size = fs::file_size(path, ec);
  if (ec) return fail(ErrorCode::kBadInput, name + ": size unknown");
  if (size > max_bytes)
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: {} bytes, at most {} are read", name, size, max_bytes));
  std::ifstream in(path, std::ios::binary);
  std::vector<unsigned char> bytes(size);
  if (!in || (size > 0 &&
              !in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))))
    return fail(ErrorCode::kBadInput, name + ": cannot be read");
  return bytes;
}

Result<fs::path> resolve_inside(const fs::path& folder, std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '\\', '/');
  const fs::path relative(text);
  const auto reject = [&](const char* why) {
    return fail(ErrorCode::kBadInput, fmt::format("file name {}: {}", in_quotes(name), why));
  };
  if (text.empty() || text.find('\0') != std::string::npos) return reject("empty or with a NUL");
  if (relative.is_absolute() || text.find(':') != std::string::npos)
    return reject("only names relative to the file's folder are followed");
  if (std::find(relative.begin(), relative.end(), "..") != relative.end())
    return reject("leaves the file's folder");
  std::error_code ec;
  const fs::path base = fs::canonical(folder.empty() ? fs::path(".") : folder, ec);
  if (ec) return reject("the file's folder cannot be read");
  const fs::path file = fs::canonical(base / relative, ec);
  if (ec) return reject("no such file");
  if (!is_inside(base, file)) return reject("links out of the file's folder");
  if (!fs::is_regular_file(file, ec)) return reject("not a regular file");
  return file;
}

}  // namespace crosspatch
