#include <algorithm>
#include <cmath>
#include <limits>

#include "app/lab/effects_accuracy.h"

namespace burrhole {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSame = 1e-9;  // [-] relative change of a figure that counts as none

/// @returns the error of a value; NaN if one of the two is absent, or if there is nothing to which it is relative.
double error_of(double value, double reference, const AccuracyFigure& figure) {
  if (value == reference) return 0.0;
  const double scale = std::max(std::abs(reference - figure.zero), figure.scale);
  return scale > 0.0 ? std::abs(value - reference) / scale : kNone;
}

LadderTrend trend_of(const std::vector<double>& values, double reference, const std::vector<double>& errors) {
  if (std::isnan(reference) && std::ranges::all_of(values, [](double v) { return std::isnan(v); })) return LadderTrend::none;
  if (std::ranges::all_of(errors, [](double e) { return e <= kSame; })) return LadderTrend::unaffected;
  for (std::size_t n = 0; n < errors.size(); ++n)
    if (std::isnan(errors[n]) || (n > 0 && errors[n] > errors[n - 1] + kLadderFloor)) return LadderTrend::stays;
  return errors.back() <= std::max(kLadderFloor, kLadderFall * errors.front()) ? LadderTrend::falls : LadderTrend::stays;
}

}  // namespace

std::vector<FigureErrors> ladder_errors(const Ladder& ladder) {
  std::vector<FigureErrors> out;
  if (ladder.runs.empty()) return std::vector<FigureErrors>(ladder.figures.size());
  for (std::size_t n = 0; n < ladder.figures.size(); ++n) {
    FigureErrors figure;
    const double reference = ladder.reference.figures[n];
    std::vector<double> values;
    for (const LadderRun& run : ladder.runs) {
      values.push_back(run.figures[n]);
      figure.errors.push_back(error_of(values.back(), reference, ladder.figures[n]));
    }
    figure.trend = trend_of(values, reference, figure.errors);
    const double ratio = ladder.runs.back().multiple / ladder.reference.multiple;
    figure.own = figure.errors.back() / (std::max(ratio, 1.0 / ratio) - 1.0);
    out.push_back(std::move(figure));
  }
  return out;
}

bool has_effect(const std::vector<FigureErrors>& errors) noexcept {
  return std::ranges::any_of(errors, [](const FigureErrors& e) { return e.trend == LadderTrend::falls || e.trend == LadderTrend::stays; });
}

const LadderRun& usual_run(const Ladder& ladder) noexcept {
  const auto found = std::ranges::find_if(ladder.runs, [](const LadderRun& run) { return run.multiple == 1.0; });
  return found != ladder.runs.end() ? *found : ladder.reference;
}

}  // namespace burrhole
