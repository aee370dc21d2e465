#include "app/lab/drilling_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kShift = 1e-6;  // [mm] between entries

constexpr std::array kFigures{DrillingFigure{"volume_off", "%", "closed form", &DrillingPoint::volume_percent},
                              DrillingFigure{"mass_off", "%", "closed form", &DrillingPoint::mass_percent},
                              DrillingFigure{"outer_diameter_off", "mm", "diameter of the bit", &DrillingPoint::outer_mm},
                              DrillingFigure{"inner_diameter_off", "mm", "diameter of the bit", &DrillingPoint::inner_mm},
                              DrillingFigure{"time_off", "%", nullptr, &DrillingPoint::time_percent, &DrillingPoint::Own::time_percent},
                              DrillingFigure{"depth_off", "mm", nullptr, &DrillingPoint::depth_mm, &DrillingPoint::Own::depth_mm},
                              DrillingFigure{"plunge_off", "mm", nullptr, &DrillingPoint::plunge_mm, &DrillingPoint::Own::plunge_mm},
                              DrillingFigure{"plunge_spread", "mm", "entries 1 nm apart", &DrillingPoint::spread_mm},
                              DrillingFigure{"feed_off", "%", nullptr, &DrillingPoint::feed_percent, &DrillingPoint::Own::feed_percent},
                              DrillingFigure{"feed_ripple", "%", "constant feed", &DrillingPoint::ripple_percent},
                              DrillingFigure{"wall_roughness", "um", "smooth wall", &DrillingPoint::roughness_um},
                              DrillingFigure{"early_stops", "runs", "breakthrough", &DrillingPoint::early_stops},
                              DrillingFigure{"cpu", "s", "measured", &DrillingPoint::cpu_s},
                              DrillingFigure{"wall", "s", "measured", &DrillingPoint::wall_s}};

/// The runs of one setting: on the bench, then the default hand at each shift.
std::vector<DrillingTrial> trials_of(const DrillingCostOptions& options, const DrillingKnob& knob, double value, double shipped) {
  std::vector<DrillingTrial> out;
  const int scripts = options.quick ? 1 : options.shifts;
  for (int n = -1; n < scripts; ++n) {
    DrillingTrial trial{.bit = options.bit, .own = options.own, .hand = n < 0 ? DrillingHand::bench : DrillingHand::script};
    if (value != shipped) knob.set(value, shipped, trial);  // the default is what a scene gets that says nothing
    if (n > 0) trial.sets.push_back(fmt::format("approach.entry_mm=[{:g}, 0, 0]", kShift * n));
    out.push_back(std::move(trial));
  }
  return out;
}

double value_or_none(const std::optional<double>& value) { return value.value_or(DrillingResult::kNone); }
double percent_off(double value, double reference) { return 100.0 * (value / reference - 1.0); }

std::string reference_text(const DrillingKnob& knob, double finest, const std::optional<double>& second) {
  const std::string out = fmt::format("{:.4g} {}{}", finest, knob.unit, knob.note);
  return second ? out + fmt::format("; its own error from {:.4g} {}", *second, knob.unit) : out;
}

/// @param levels bench and default hand of the reference, then of its second level.
DrillingPoint::Own own_errors(std::span<const DrillingResult> levels) {
  const DrillingResult &bench = levels[0], &script = levels[1], &second_bench = levels[2], &second_script = levels[3];
  return {.time_percent = std::abs(percent_off(second_script.drilled_s, script.drilled_s)),
          .depth_mm = std::abs(value_or_none(second_script.summary.depth_mm) - value_or_none(script.summary.depth_mm)),
          .plunge_mm = std::abs(second_script.plunge_mm - script.plunge_mm),
          .feed_percent = std::abs(percent_off(second_bench.feed_mm_s, bench.feed_mm_s))};
}

/// @param runs of one setting, as trials_of() lists them. @param finer the same of the reference.
void fill(std::span<const DrillingResult> runs, std::span<const DrillingResult> finer, double diameter_mm, DrillingPoint& out) {
  const DrillingResult &bench = runs[0], &script = runs[1];
  out.volume_percent = percent_off(bench.summary.removed_mm3, bench.volume_mm3);
  out.mass_percent = percent_off(bench.summary.removed_mass_mm3, bench.volume_mm3);
  out.outer_mm = value_or_none(bench.summary.hole_diameter_mm) - diameter_mm;
  out.inner_mm = value_or_none(bench.summary.inner_diameter_mm) - diameter_mm;
  out.feed_percent = percent_off(bench.feed_mm_s, finer[0].feed_mm_s);
  out.ripple_percent = bench.ripple_percent;
  out.roughness_um = bench.roughness_um;
  out.time_percent = percent_off(script.drilled_s, finer[1].drilled_s);
  out.depth_mm = value_or_none(script.summary.depth_mm) - value_or_none(finer[1].summary.depth_mm);
  out.plunge_mm = script.plunge_mm - finer[1].plunge_mm;
  double least = script.plunge_mm, most = script.plunge_mm;
  for (const DrillingResult& run : runs.subspan(1)) {
    least = std::min(least, run.plunge_mm);
    most = std::max(most, run.plunge_mm);
    out.early_stops += std::isnan(run.drilled_s) ? 1.0 : 0.0;
  }
  out.spread_mm = runs.size() > 2 ? most - least : DrillingResult::kNone;
  out.cpu_s = script.cpu_s;
  out.wall_s = script.wall_s;
  out.median_us = script.median_us;
  out.p99_us = script.p99_us;
  out.bytes = static_cast<double>(script.summary.predicted_bytes);
}

}  // namespace

std::span<const DrillingFigure> drilling_figures() noexcept { return kFigures; }

Result<std::vector<DrillingPoint>> measure_drilling_cost(const DrillingCostOptions& options) {
  const auto loaded = load_drilling({.bit = options.bit, .own = options.own}, options.runs.tool_folder);
  if (!loaded) return loaded.error();
  const DrillingBit& bit = options.own ? *options.own : *find_drilling_bit(options.bit);
  std::vector<DrillingPoint> points;
  std::vector<DrillingTrial> trials;
  std::vector<std::size_t> reference_of;  // per point, its first of finest
  std::vector<DrillingTrial> finest;      // per knob bench and default hand, then those of the second level if there is one
  for (const DrillingKnob& knob : drilling_knobs()) {
    if (!options.only_knob.empty() && options.only_knob != knob.name) continue;
    const double shipped = knob.shipped(*loaded);
    const double finest_setting = finest_value(knob, bit, options.quick, shipped);
    const std::size_t reference = finest.size();
    const std::optional<double> second = second_value(knob, bit, options.quick, shipped);
    for (const std::optional<double> level : {std::optional(finest_setting), second}) {
      if (!level) continue;
      const auto finer = trials_of(options, knob, *level, shipped);
      finest.insert(finest.end(), finer.begin(), finer.begin() + 2);  // without the shifts
    }
    for (const double multiple : options.quick ? knob.quick : knob.multiples) {
      DrillingPoint point{.knob = knob.name, .unit = knob.unit, .reference = reference_text(knob, finest_setting, second)};
      point.has_second = second.has_value();
      point.setting = multiple * shipped;
      point.shipped = shipped;
      const double point_value = point.setting;
      points.push_back(std::move(point));
      reference_of.push_back(reference);
      for (DrillingTrial& trial : trials_of(options, knob, point_value, shipped)) trials.push_back(std::move(trial));
    }
  }
  if (points.empty()) {
    std::string known;
    for (const DrillingKnob& knob : drilling_knobs()) known += (known.empty() ? "" : ", ") + knob.name;
    return bad_input("the drilling study has no setting \"" + options.only_knob + "\"; it has " + known);
  }
  const std::size_t each = trials.size() / points.size(), finer = finest.size();
  finest.insert(finest.end(), trials.begin(), trials.end());  // the finest take longest, so they come first
  const auto results = run_drillings(finest, options.runs);
  if (!results) return results.error();
  const std::span<const DrillingResult> all(*results);
  const double diameter_mm = 2.0 * bit.swept.radius / kMillimetre;
  for (std::size_t n = 0; n < points.size(); ++n) {
    fill(all.subspan(finer + n * each, each), all.subspan(reference_of[n], 2), diameter_mm, points[n]);
    if (points[n].has_second) points[n].own = own_errors(all.subspan(reference_of[n], 4));
  }
  return points;
}

std::vector<CostRow> drilling_cost_rows(const std::vector<DrillingPoint>& points, const std::string& bit) {
  std::vector<CostRow> rows;
  for (const DrillingPoint& point : points)
    for (const DrillingFigure& figure : kFigures) {
      CostRow row{.subject = "hole of the " + bit + " bit through a plate",
                  .model = "as shipped",
                  .knob = point.knob,
                  .setting = point.setting,
                  .error_name = figure.name,
                  .error = point.*figure.value,
                  .unit = figure.unit,
                  .reference = figure.reference != nullptr ? figure.reference : point.reference};
      row.median_us = point.median_us;
      row.p99_us = point.p99_us;
      row.bytes = point.bytes;
      rows.push_back(row);
      if (figure.own == nullptr) continue;
      row.error_name += "_own";  // of the reference
      row.error = point.own.*figure.own;
      rows.push_back(std::move(row));
    }
  return rows;
}

}  // namespace burrhole
