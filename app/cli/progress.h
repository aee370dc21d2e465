/// app/cli/progress.h: a bar on a terminal, plain lines otherwise; always on stderr.
#pragma once

#include <string>

namespace burrhole::cli {

class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  /// `share` 0..1 of the work, `text` beside it. Redraws a bar in place; as plain lines says something every tenth.
  void show(double share, const std::string& text);

 private:
  bool quiet_, terminal_;
  int last_tenth_ = -1;
  bool drawn_ = false;
};

}  // namespace burrhole::cli
