#include "app/report/plot_range.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace burrhole {
namespace {

constexpr double kLargest = 1e290, kLeast = 1e-290;  // room below 1e300, where data_block() puts what is never shown
constexpr double kThinnest = 1e-9;                   // length of an axis over its largest value, which the digits of its numbers still show

std::optional<PlotRange> given(const std::optional<std::pair<double, double>>& range, bool log) noexcept {
  if (!range) return std::nullopt;
  const PlotRange out{range->first, range->second};
  return out.is_drawable(log) ? std::optional(out) : std::nullopt;
}

double size_of(const PlotRange& range) noexcept { return std::max(std::abs(range.lo), std::abs(range.hi)); }

/// Whether a curve runs along zero, where the frame would hide it. @param most of the axis.
bool runs_along_zero(const PlotPanel& panel, double most) noexcept {
  constexpr double kHidden = 0.004;  // [-] of the axis
  for (const PlotSeries& series : panel.series)
    for (std::size_t n = 1; n < series.y.size(); ++n)
      if (std::abs(series.y[n - 1]) <= kHidden * most && std::abs(series.y[n]) <= kHidden * most) return true;
  return false;
}

}  // namespace

bool can_be_drawn(double value, bool log) noexcept { return std::abs(value) <= kLargest && (!log || value >= kLeast); }

void PlotRange::include(double value, bool log) noexcept {
  if (!can_be_drawn(value, log)) return;
  lo = std::min(lo, value);
  hi = std::max(hi, value);
}

bool PlotRange::is_drawable(bool log) const noexcept {
  return can_be_drawn(lo, log) && can_be_drawn(hi, log) && hi - lo > std::max(kLeast, kThinnest * size_of(*this));
}

PlotRange PlotRange::drawable(bool log) const noexcept {
  if (lo > hi) return {log ? 0.1 : 0.0, 1.0};
  if (is_drawable(log)) return *this;
  if (log) return {0.5 * lo, 2.0 * hi};
  const double room = std::max(0.5, 1e-3 * size_of(*this));
  return {lo - room, hi + room};
}

PlotRange x_axis_of(std::span<const PlotPanel> panels, bool log) noexcept {
  PlotRange range;
  for (const PlotPanel& panel : panels) {
    if (const auto set = given(panel.x_range, log)) return *set;
    for (const PlotSeries& series : panel.series)
      for (const double x : series.x) range.include(x, log);
  }
  return range.drawable(log);
}

PlotRange y_axis_of(const PlotPanel& panel, bool log) noexcept {
  if (const auto set = given(panel.y_range, log)) return *set;
  PlotRange range;
  for (const PlotSeries& series : panel.series)
    for (const double y : series.y) range.include(y, log);
  for (const PlotBand& band : panel.bands) {
    range.include(band.from, log);
    range.include(band.to, log);
  }
  if (panel.from_zero) range.include(0.0, log);
  const bool is_empty = range.lo > range.hi;
  range = range.drawable(log);
  if (log) return is_empty ? range : PlotRange{range.lo / 1.2, range.hi * 1.2};
  // Room for the line's own width; an axis that starts at zero keeps its zero on the frame, except where a curve runs along it.
  const double room = 0.06 * (range.hi - range.lo);
  const bool on_frame = panel.from_zero && range.lo == 0.0 && !runs_along_zero(panel, range.hi);
  return {on_frame ? 0.0 : range.lo - room, range.hi + room};
}

}  // namespace burrhole
