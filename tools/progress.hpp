#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace crosspatch {

/// What a finished stage took.
struct StageRecord {
  std::string name;
  double seconds = 0;
  double peak_memory_mib = 0;  ///< of the whole process up to the stage's end
};

/// Tells a person on standard error how far a run has come: one line a finished stage, and on a
/// terminal a bar below them while a stage runs.
class Progress {
 public:
  /// `stages` is the number of stages of the whole run, for the bar.
  Progress(bool quiet, int stages);

  /// Begins a stage; ends the one before it where that is still open.
  void begin(const std::string& stage);
  /// Ends the stage begun last; `summary` says on one line what came out of it.
  void end(const std::string& summary = "");
  /// Takes the bar away, so that an error line stands alone.
  void clear_bar() const;

  [[nodiscard]] const std::vector<StageRecord>& records() const { return records_; }

 private:
  /// ", about N s left", or nothing where that cannot be told.
  [[nodiscard]] std::string time_left() const;

  bool quiet_;
  bool terminal_;
  int stages_;
  std::string stage_;
  std::chrono::steady_clock::time_point begun_;
  std::vector<StageRecord> records_;
};

/// One line of a figure on standard error.
void print_figure(const std::string& name, double value);

/// One warning line on standard error.
void print_warning(const std::string& warning);

/// The most memory the process has held so far, MiB.
double peak_memory_mib();

}  // namespace crosspatch
