/// app/cli/progress.h: a bar on a terminal, plain lines otherwise; always on stderr.
#pragma once

#include <chrono>
#include <string>

namespace burrhole::cli {

/// For reading files: most are read before anyone wonders.
inline constexpr std::chrono::milliseconds kPatience{1000};

class Progress {
 public:
  /// Nothing is shown in the first `patience`: what is done by then needs no bar.
  explicit Progress(bool quiet, std::chrono::milliseconds patience = std::chrono::milliseconds(0));
  ~Progress();
  /// `share` 0..1 of the work, `text` beside it. Redraws a bar in place; as plain lines says something every tenth.
  void show(double share, const std::string& text);
  /// A line of its own, below a bar that was drawn.
  void say(const std::string& line);

 private:
  bool quiet_, terminal_;
  std::chrono::steady_clock::time_point from_;
  int last_tenth_ = -1;
  bool drawn_ = false;
};

}  // namespace burrhole::cli
