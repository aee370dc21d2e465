#include "app/lab/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace burrhole {
namespace {

constexpr double kMinute = 60.0;
constexpr int kMinutes = 60;  // of an hour

}  // namespace

std::string duration_text(double seconds) {
  if (seconds < kMinute) return "under a minute";
  const auto minutes = static_cast<int>(std::lround(seconds / kMinute));
  if (minutes < kMinutes) return fmt::format("about {} min", minutes);
  return fmt::format("about {} h {} min", minutes / kMinutes, minutes % kMinutes);
}

Study::Study(StudyRuns runs, std::size_t trials) : runs_(std::move(runs)), results_(runs_.partial), trials_(trials) {}

double Study::now() const {
  if (runs_.now) return runs_.now();
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void Study::estimate() {
  const std::size_t left = trials_ - std::min(trials_, done());
  if (!runs_.say || left == 0) return;
  std::string line = fmt::format("{} of {} trials left: {}, if all take as long as the first ({:.3g} s)", left, trials_,
                                 duration_text(spent_ * static_cast<double>(left)), spent_);
  if (earlier_ > 0) line += fmt::format("; {} were measured by an earlier call (--fresh measures all again)", earlier_);
  runs_.say(line);
}

Result<Study::Figures> Study::run(const StudyTrial& trial, const std::function<Result<Figures>()>& measure) {
  const std::string key = trial.key.text();
  if (auto kept = results_.find(key, trial.figures)) {
    ++earlier_;
    return std::move(*kept);
  }
  const double start = now();
  auto figures = measure();
  if (!figures) return figures;
  spent_ += now() - start;
  ++measured_;
  if (Status kept = results_.add(key, *figures); !kept) return kept.error();
  if (measured_ == 1) estimate();
  // What an earlier call did takes no time, so that a share with it would make the rest seem short.
  if (runs_.progress)
    runs_.progress(static_cast<double>(measured_) / static_cast<double>(std::max(measured_, trials_ - std::min(trials_, earlier_))),
                   trial.name);
  return figures;
}

}  // namespace burrhole
