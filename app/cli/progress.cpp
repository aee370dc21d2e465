#include "app/cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "app/cli/commands.h"

namespace burrhole::cli {

Progress::Progress(bool quiet, std::chrono::milliseconds delay, bool estimates)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), estimates_(estimates), from_(std::chrono::steady_clock::now() + delay) {}

std::string Progress::left(double share) const {
  constexpr double kLeastShare = 0.01, kLeast = 2.0;  // [-], [s]
  const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - from_).count();
  if (!estimates_ || share < kLeastShare || share >= 1.0 || spent < kLeast) return {};
  const double seconds = spent / share * (1.0 - share);
  constexpr double kMinute = 60.0;
  if (seconds < kMinute) return ", less than a minute left";
  return ", about " + std::to_string(static_cast<int>(seconds / kMinute + 0.5)) + " min left";
}

Progress::~Progress() {
  if (drawn_) std::fputc('\n', stderr);
}

void Progress::show(double share, const std::string& text) {
  if (quiet_ || std::chrono::steady_clock::now() < from_) return;
  share = std::clamp(share, 0.0, 1.0);
  const std::string line = text + left(share);
  if (terminal_) {
    constexpr int kWidth = 30;
    const int full = static_cast<int>(share * kWidth);
    std::fprintf(stderr, "\r[%.*s%*s] %s\033[K", full, "##############################", kWidth - full, "", line.c_str());
    drawn_ = true;
  } else if (const int tenth = static_cast<int>(share * 10.0); tenth > last_tenth_) {
    last_tenth_ = tenth;
    std::fprintf(stderr, "%3d %% %s\n", tenth * 10, line.c_str());
  }
}

void Progress::say(const std::string& line) {
  if (quiet_) return;
  if (drawn_) std::fputc('\n', stderr);
  drawn_ = false;
  print_line(line);
}

}  // namespace burrhole::cli
