#include "tools/output_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <set>
#include <system_error>

namespace crosspatch {
namespace {

namespace fs = std::filesystem;

constexpr std::array<int, 3> kEndingSignals = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t g_waiting_signal = 0;

extern "C" void remember_signal(int signal) {
  g_waiting_signal = signal;
}

/// Puts signals that end the program off until it goes out of scope. The process-wide handler is
/// needed, a mask is not enough: other threads would still receive them.
class SignalDelay {
 public:
  SignalDelay() {
    struct sigaction action {};
    action.sa_handler = remember_signal;
    for (std::size_t i = 0; i < kEndingSignals.size(); ++i)
      sigaction(kEndingSignals[i], &action, &before_[i]);
  }
  SignalDelay(const SignalDelay&) = delete;
  SignalDelay& operator=(const SignalDelay&) = delete;
  ~SignalDelay() {
    for (std::size_t i = 0; i < kEndingSignals.size(); ++i)
      sigaction(kEndingSignals[i], &before_[i], nullptr);
    if (g_waiting_signal != 0) std::raise(g_waiting_signal);
  }

 private:
  std::array<struct sigaction, kEndingSignals.size()> before_{};
};

Status output_error(const std::string& path, const std::string& reason) {
  return fail(ErrorCode::kOutput, fmt::format("output '{}': {}", path, reason));
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

bool is_device(const fs::path& path) {
  std::error_code ignored;
  return fs::is_character_file(path, ignored) || fs::is_fifo(path, ignored);
}

/// Name beside `path` for its unfinished file.
std::string unfinished(const std::string& path) {
  return fmt::format("{}.{}.part", path, getpid());
}

bool write_all(int file, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(file, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

Status write_unfinished(const OutputFile& file) {
  const std::string part = unfinished(file.path);
  const int descriptor = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return output_error(file.path, std::strerror(errno));
  const bool written = write_all(descriptor, file.bytes) && fsync(descriptor) == 0;
  const int reason = errno;
  if (close(descriptor) != 0 || !written) return output_error(file.path, std::strerror(reason));
  return {};
}

/// Standard output and devices cannot be renamed to; they are written straight.
bool is_stream(const std::string& path) {
  return path == "-" || is_device(path);
}

Status write_stream(const OutputFile& file) {
  const int descriptor =
      file.path == "-" ? STDOUT_FILENO : open(file.path.c_str(), O_WRONLY | O_CLOEXEC);
  const bool written = descriptor >= 0 && write_all(descriptor, file.bytes);
  const int reason = errno;
  if (descriptor > STDERR_FILENO) close(descriptor);
  return written ? Status{} : output_error(file.path, std::strerror(reason));
}

}  // namespace

Status check_output_paths(const std::vector<std::string>& paths) {
  std::set<std::string> seen;
  for (const std::string& path : paths) {
    if (!seen.insert(path == "-" ? path : fs::absolute(path).lexically_normal().string()).second)
      return output_error(path, "is named twice");
    if (is_stream(path)) continue;
    std::error_code ignored;
    if (path.empty() || fs::is_directory(path, ignored))
      return output_error(path, "is a folder, a file is needed");
    const fs::path folder = folder_of(path);
    if (!fs::is_directory(folder, ignored))
      return output_error(path, fmt::format("folder '{}' does not exist", folder.string()));
    if (access(folder.c_str(), W_OK) != 0)
      return output_error(path, fmt::format("folder '{}' may not be written to", folder.string()));
  }
  return {};
}

Status write_output_files(const std::vector<OutputFile>& files) {
  const SignalDelay delay;
  Status status;
  std::size_t begun = 0;
  for (; begun < files.size() && status; ++begun)
    if (!is_stream(files[begun].path)) status = write_unfinished(files[begun]);
  for (std::size_t i = 0; i < files.size() && status; ++i) {
    const std::string& path = files[i].path;
    if (!is_stream(path) && std::rename(unfinished(path).c_str(), path.c_str()) != 0)
      status = output_error(path, std::strerror(errno));
  }
  for (std::size_t i = 0; i < files.size() && status; ++i)
    if (is_stream(files[i].path)) status = write_stream(files[i]);
  if (!status)
    for (std::size_t i = 0; i < begun; ++i) unlink(unfinished(files[i].path).c_str());
  return status;
}

}  // namespace crosspatch
