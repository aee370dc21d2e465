#include "app/lab/drilling_partial.h"

#include <fmt/format.h>

#include <array>

#include "app/lab/drilling_bits.h"

namespace burrhole {
namespace {

constexpr std::size_t kFigures = 17;
using FigureList = std::array<double, kFigures>;

FigureList figures_of(const DrillingResult& r) {
  const auto value = [](const std::optional<double>& v) { return v.value_or(DrillingResult::kNone); };
  const RunSummary& s = r.summary;
  return {r.volume_mm3,
          r.drilled_s,
          r.plunge_mm,
          r.feed_mm_s,
          r.ripple_percent,
          r.roughness_um,
          r.cpu_s,
          r.wall_s,
          r.median_us,
          r.p99_us,
          s.removed_mm3,
          s.removed_mass_mm3,
          s.spacing_mm,
          value(s.depth_mm),
          value(s.hole_diameter_mm),
          value(s.inner_diameter_mm),
          static_cast<double>(s.predicted_bytes)};
}

DrillingResult result_of(const std::vector<double>& f) {
  const auto known = [](double v) { return v == v ? std::optional(v) : std::nullopt; };
  DrillingResult r;
  r.volume_mm3 = f[0];
  r.drilled_s = f[1];
  r.plunge_mm = f[2];
  r.feed_mm_s = f[3];
  r.ripple_percent = f[4];
  r.roughness_um = f[5];
  r.cpu_s = f[6];
  r.wall_s = f[7];
  r.median_us = f[8];
  r.p99_us = f[9];
  r.summary.removed_mm3 = f[10];
  r.summary.removed_mass_mm3 = f[11];
  r.summary.spacing_mm = f[12];
  r.summary.depth_mm = known(f[13]);
  r.summary.hole_diameter_mm = known(f[14]);
  r.summary.inner_diameter_mm = known(f[15]);
  r.summary.predicted_bytes = static_cast<std::uint64_t>(f[16]);
  return r;
}

}  // namespace

Result<std::string> key_of(const DrillingTrial& trial, const std::string& tool_folder) {
  const DrillingBit* bit = bit_of(trial);
  if (bit == nullptr) return bad_input("the drilling study has no bit \"" + trial.bit + "\"");
  const auto tool = drilling_bit_text(*bit, tool_folder);
  if (!tool) return tool.error();
  TrialKey key;
  key.add(drilling_scene(trial)).add(*tool);
  for (const auto* list : {&trial.sets, &trial.tool_sets}) {
    for (const std::string& one : *list) key.add(one);
    key.add("");
  }
  return key.text();
}

std::optional<DrillingResult> PartialDrillings::find(const DrillingTrial& trial) const {
  const auto key = key_of(trial, tool_folder_);
  const auto figures = key ? results_.find(*key, kFigures) : std::nullopt;
  return figures ? std::optional(result_of(*figures)) : std::nullopt;
}

Status PartialDrillings::add(const DrillingTrial& trial, const DrillingResult& result) {
  const auto key = key_of(trial, tool_folder_);
  return key ? results_.add(*key, figures_of(result)) : Status(key.error());
}

}  // namespace burrhole
