#include "volumes/read/layer_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kLeastBlur = 0.1e-3, kMostBlur = 1.5e-3;  // [m]
constexpr double kRoot2Pi = 2.5066282746310002;
constexpr int kRounds = 12;
constexpr double kGain = 0.7;  // [-] of a correction: 1 overshoots where a table is thinner than the blur

/// Share of a unit step at 0 that a Gaussian of standard deviation 1 leaves at x: a table of portable_exp, interpolated.
class SmoothStep {
 public:
  SmoothStep() {
    double sum = 0.0;
    for (std::size_t n = 0; n < table_.size(); ++n) {
      table_[n] = sum;
      const double x = (static_cast<double>(n) + 0.5) * kStep - kEnd;
      sum += portable_exp(-0.5 * x * x) * kStep / kRoot2Pi;
    }
    for (double& value : table_) value /= table_.back();
  }
  [[nodiscard]] double at(double x) const noexcept {
    const double u = std::clamp((x + kEnd) / kStep, 0.0, static_cast<double>(table_.size() - 1));
    const auto n = std::min(static_cast<std::size_t>(u), table_.size() - 2);
    return table_[n] + (table_[n + 1] - table_[n]) * (u - static_cast<double>(n));
  }

 private:
  static constexpr double kEnd = 5.0, kStep = 0.02;
  std::array<double, 501> table_{};
};

const SmoothStep& smooth_step() {
  static const SmoothStep out;
  return out;
}

/// What is measured on a profile.
struct Features {
  double outer_peak = 0.0, inner_peak = 0.0, least = 0.0;                             // [unit of the scan]
  double outer_edge = 0.0, outer_border = 0.0, inner_border = 0.0, inner_edge = 0.0;  // [m]
};

/// Depth at which the profile passes `level` between two indices, from the first on in the direction of the second; that of the second if not.
double crossing(const LayerProfile& p, std::size_t from, std::size_t to, double level) {
  const std::ptrdiff_t way = from < to ? 1 : -1;
  auto n = static_cast<std::ptrdiff_t>(from);
  const auto value = [&](std::ptrdiff_t m) { return static_cast<double>(p.values[static_cast<std::size_t>(m)]); };
  for (; n != static_cast<std::ptrdiff_t>(to); n += way) {
    const double a = value(n), b = value(n + way);
    if ((a - level) * (b - level) > 0.0 || a == b) continue;
    return p.depth_of(static_cast<double>(n) + static_cast<double>(way) * (level - a) / (b - a));
  }
  return p.depth_of(static_cast<double>(to));
}

/// The value of a peak by the parabola through its sample and the next two.
double peak_value(const LayerProfile& p, std::size_t n) {
  if (n == 0 || n + 1 >= p.values.size()) return static_cast<double>(p.values[n]);
  const auto a = static_cast<double>(p.values[n - 1]), b = static_cast<double>(p.values[n]), c = static_cast<double>(p.values[n + 1]);
  const double bend = a - 2.0 * b + c;
  return bend == 0.0 ? b : b - (a - c) * (a - c) / (8.0 * bend);
}

struct Marks {
  std::size_t begin, outer, least, inner, end;  // indices: outside, outer peak, least value, inner peak, inside
};

std::size_t index_at(const LayerProfile& p, double depth) {
  return static_cast<std::size_t>(std::clamp((depth - p.start) / p.step + 0.5, 0.0, static_cast<double>(p.values.size() - 1)));
}

/// @returns nothing if there are no two peaks. The peaks are sought in half of the bone each, at most 5 mm deep, since no table is thicker.
std::optional<Marks> find_marks(const LayerProfile& p, const LayerLimits& limits) {
  constexpr double kDeepestPeak = 5e-3;
  const double half = std::min(0.5 * limits.thickness, kDeepestPeak);
  const auto at = [&](std::size_t n) { return p.values.begin() + static_cast<std::ptrdiff_t>(n); };
  const auto place = [&](auto i) { return static_cast<std::size_t>(i - p.values.begin()); };
  Marks out{};
  out.begin = index_at(p, -limits.outside_depth);
  out.end = index_at(p, limits.thickness + limits.outside_depth);
  out.outer = place(std::max_element(at(index_at(p, 0.0)), at(index_at(p, half)) + 1));
  out.inner = place(std::max_element(at(index_at(p, limits.thickness - half)), at(index_at(p, limits.thickness)) + 1));
  if (out.inner < out.outer + 2) return std::nullopt;
  out.least = place(std::min_element(at(out.outer), at(out.inner) + 1));
  if (out.least == out.outer || out.least == out.inner) return std::nullopt;
  return out;
}

Features measure(const LayerProfile& p, const Marks& m) {
  Features f;
  const auto value = [&](std::size_t n) { return static_cast<double>(p.values[n]); };
  f.outer_peak = peak_value(p, m.outer);
  f.inner_peak = peak_value(p, m.inner);
  f.least = peak_value(p, m.least);
  f.outer_edge = crossing(p, m.outer, m.begin, 0.5 * (value(m.begin) + f.outer_peak));
  f.inner_edge = crossing(p, m.inner, m.end, 0.5 * (value(m.end) + f.inner_peak));
  f.outer_border = crossing(p, m.outer, m.least, 0.5 * (f.least + f.outer_peak));
  f.inner_border = crossing(p, m.inner, m.least, 0.5 * (f.least + f.inner_peak));
  return f;
}

/// The blur by the steepest slope of the outer edge: a step of height h has h / (sqrt(2 pi) blur).
double blur_of(const LayerProfile& p, const Marks& m, double peak) {
  double slope = 0.0;
  for (std::size_t n = m.begin; n < m.outer; ++n) slope = std::max(slope, static_cast<double>(p.values[n + 1] - p.values[n]) / p.step);
  const double height = peak - static_cast<double>(p.values[m.begin]);
  return slope > 0.0 ? std::clamp(height / (kRoot2Pi * slope), kLeastBlur, kMostBlur) : kMostBlur;
}

/// Fills the values of the blurred model, on the depths of `out`.
void fill_model(const Features& model, double outside, double inside, double blur, LayerProfile& out) {
  const std::array<double, 4> edges{model.outer_edge, model.outer_border, model.inner_border, model.inner_edge};
  const std::array<double, 5> pieces{outside, model.outer_peak, model.least, model.inner_peak, inside};
  for (std::size_t n = 0; n < out.values.size(); ++n) {
    const double depth = out.depth_of(static_cast<double>(n));
    double value = pieces[0];
    for (std::size_t e = 0; e < edges.size(); ++e) value += (pieces[e + 1] - pieces[e]) * smooth_step().at((depth - edges[e]) / blur);
    out.values[n] = static_cast<float>(value);
  }
}

void keep_order(const LayerLimits& limits, Features& model) {
  const double middle = 0.5 * (model.outer_edge + model.inner_edge);
  const double least = std::min(limits.least_table, middle - model.outer_edge);
  model.outer_border = std::clamp(model.outer_border, model.outer_edge + least, std::max(middle, model.outer_edge + least));
  model.inner_border = std::clamp(model.inner_border, std::min(middle, model.inner_edge - least), model.inner_edge - least);
  model.outer_peak = std::min(model.outer_peak, limits.most_value);
  model.inner_peak = std::min(model.inner_peak, limits.most_value);
}

}  // namespace

double LayerProfile::at(double depth) const noexcept {
  const double u = std::clamp((depth - start) / step, 0.0, static_cast<double>(values.size() - 1));
  const auto n = std::min(static_cast<std::size_t>(u), values.size() - 2);
  const auto a = static_cast<double>(values[n]), b = static_cast<double>(values[n + 1]);
  return a + (b - a) * (u - static_cast<double>(n));
}

LayerBorders find_layers(const LayerProfile& profile, const LayerLimits& limits) {
  LayerBorders out;
  out.inner_edge = limits.thickness;
  const auto marks = find_marks(profile, limits);
  if (!marks) return out;
  const Features seen = measure(profile, *marks);
  const auto outside = static_cast<double>(profile.values[marks->begin]), inside = static_cast<double>(profile.values[marks->end]);
  const double peak = std::min(seen.outer_peak, seen.inner_peak), height = peak - std::max(outside, inside);
  if (height <= 0.0) return out;
  out.dip = (peak - seen.least) / height;
  out.blur = limits.blur > 0.0 ? limits.blur : blur_of(profile, *marks, seen.outer_peak);
  if (out.dip < limits.least_dip) return out;

  Features model = seen;
  LayerProfile drawn{profile.start, profile.step, std::vector<float>(profile.values.size())};
  for (int round = 0; round < kRounds; ++round) {
    keep_order(limits, model);
    fill_model(model, outside, inside, out.blur, drawn);
    const auto drawn_marks = find_marks(drawn, limits);
    if (!drawn_marks) break;
    const Features got = measure(drawn, *drawn_marks);
    for (double Features::*f : {&Features::outer_peak, &Features::inner_peak, &Features::least, &Features::outer_edge,
                                &Features::outer_border, &Features::inner_border, &Features::inner_edge})
      model.*f += kGain * (seen.*f - got.*f);
  }
  keep_order(limits, model);
  out.is_layered = true;
  out.outer_edge = model.outer_edge;
  out.inner_edge = model.inner_edge;
  out.outer = model.outer_border;
  out.inner = model.inner_border;
  out.table_value = std::max(model.outer_peak, model.inner_peak);
  out.diploe_value = model.least;
  return out;
}

}  // namespace burrhole
