#include "app/lab/drilling_partial.h"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "core/base/hash.h"
#include "core/base/output_file.h"
#include "core/base/physics_version.h"

namespace burrhole {
namespace {

constexpr std::size_t kFigures = 16;
using FigureList = std::array<double, kFigures>;

std::string key_of(const DrillingTrial& trial) {
  Hash64 hash;
  const auto add = [&](const std::string& text) {
    for (const char c : text) hash.add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
    hash.add(std::uint64_t{256});  // ends a text
  };
  add(drilling_scene(trial));
  add(trial.bit);
  for (const auto* list : {&trial.sets, &trial.tool_sets}) {
    for (const std::string& one : *list) add(one);
    add("");
  }
  hash.add(static_cast<std::uint64_t>(kPhysicsVersion));
  return hash.hex();
}

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
          value(s.inner_diameter_mm)};
}

DrillingResult result_of(const FigureList& f, std::uint64_t bytes) {
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
  r.summary.predicted_bytes = bytes;
  return r;
}

}  // namespace

PartialDrillings::PartialDrillings(std::string path) : path_(std::move(path)) {
  std::ifstream file(path_);
  for (std::string line; !path_.empty() && std::getline(file, line) && !file.eof();) {  // a line without an end was cut off
    std::istringstream words(line);
    std::string key, word;
    std::uint64_t bytes = 0;
    FigureList figures{};
    std::size_t count = 0;
    words >> key >> bytes;
    while (count < kFigures && words >> word) figures[count++] = std::strtod(word.c_str(), nullptr);
    if (count == kFigures) results_[key] = result_of(figures, bytes);
  }
}

std::optional<DrillingResult> PartialDrillings::find(const DrillingTrial& trial) const {
  const auto found = path_.empty() ? results_.end() : results_.find(key_of(trial));
  return found != results_.end() ? std::optional(found->second) : std::nullopt;
}

Status PartialDrillings::add(const DrillingTrial& trial, const DrillingResult& result) {
  if (path_.empty()) return {};
  std::string line = fmt::format("{} {}", key_of(trial), result.summary.predicted_bytes);
  for (const double figure : figures_of(result)) line += fmt::format(" {:a}", figure);
  return append_to_file(path_, line + "\n");
}

}  // namespace burrhole
