/// app/cli/progress.h: progress output on stderr: a bar on a terminal, plain lines otherwise.   Thread  one.
#pragma once

#include <chrono>
#include <string>

namespace burrhole::cli {

/// [ms] delay before the bar for reading files appears; most files are read in less.
inline constexpr std::chrono::milliseconds kReadingDelay{1000};

class Progress {
 public:
  /// @param quiet prints nothing. @param delay time after construction in which show() prints nothing.
  /// @param estimates adds the time that is left, from the share that is done, once it can be estimated.
  explicit Progress(bool quiet, std::chrono::milliseconds delay = std::chrono::milliseconds(0), bool estimates = false);
  ~Progress();
  /// Redraws the bar in place; without a terminal, prints one line per tenth of the work. @param share of the work that is done, 0..1.
  void show(double share, const std::string& text);
  /// Prints one line, below a bar that was drawn.
  void say(const std::string& line);

 private:
  [[nodiscard]] std::string left(double share) const;
  bool quiet_, terminal_, estimates_;
  std::chrono::steady_clock::time_point from_;
  int last_tenth_ = -1;
  bool drawn_ = false;
};

}  // namespace burrhole::cli
