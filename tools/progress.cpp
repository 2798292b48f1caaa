#include "tools/progress.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace crosspatch {

Progress::Progress(bool quiet, int stages)
    : quiet_(quiet), terminal_(!quiet && isatty(STDERR_FILENO) != 0), stages_(stages) {}

void Progress::begin(const std::string& stage) {
  if (!stage_.empty()) end();
  stage_ = stage;
  begun_ = std::chrono::steady_clock::now();
  if (!terminal_) return;
  constexpr std::size_t kBarWidth = 24;
  const std::size_t done =
      std::min(kBarWidth, kBarWidth * records_.size() / static_cast<std::size_t>(stages_));
  const std::string bar = std::string(done, '#') + std::string(kBarWidth - done, '.');
  fmt::print(
      stderr, "\r\033[K[{}] {}/{} {}{}", bar, records_.size() + 1, stages_, stage, time_left());
  std::fflush(stderr);
}

std::string Progress::time_left() const {
  // Shares of the time that stages take in a run over two meshes of 10000 triangles; the order of
  // the stages of other runs is the same.
  static const std::map<std::string, double> shares{{"source", 0.01},
                                                    {"target", 0.01},
                                                    {"features", 0.05},
                                                    {"embedding", 0.2},
                                                    {"symmetry", 0.1},
                                                    {"judging", 0.06},
                                                    {"finals", 0.3},
                                                    {"map", 0.35},
                                                    {"transfer", 0.02}};
  double seconds = 0, done = 0, total = 0;
  for (const auto& entry : shares) total += entry.second;
  for (const StageRecord& record : records_) {
    seconds += record.seconds;
    if (const auto share = shares.find(record.name); share != shares.end()) done += share->second;
  }
  // Reading says nothing about the rest.
  constexpr double kTelling = 0.03;
  if (done < kTelling || done >= total) return "";
  return fmt::format(", about {:.0f} s left", std::ceil(seconds / done * (total - done)));
}

void Progress::end(const std::string& summary) {
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun_;
  records_.push_back({stage_, taken.count(), peak_memory_mib()});
  clear_bar();
  if (!quiet_)
    fmt::print(stderr,
               "{:<9} {:7.2f} s{}{}\n",
               stage_,
               taken.count(),
               summary.empty() ? "" : "  ",
               summary);
  stage_.clear();
}

void Progress::clear_bar() const {
  if (terminal_) fmt::print(stderr, "\r\033[K");
}

void print_figure(const std::string& name, double value) {
  fmt::print(stderr, "  {:<28} {:.6g}\n", name, value);
}

void print_warning(const std::string& warning) {
  fmt::print(stderr, "crosspatch: warning: {}\n", warning);
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts kB
}

}  // namespace crosspatch
