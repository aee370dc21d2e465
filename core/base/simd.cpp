#include "core/base/simd.h"

#include <hwy/targets.h>

#include <algorithm>
#include <array>

namespace burrhole {
namespace {

struct LevelInfo {
  SimdLevel level;
  std::string_view name;
  std::int64_t target;  // Highway's bit; a lower bit is a better target
};
constexpr std::array<LevelInfo, 3> kLevels{
    {{SimdLevel::sse4, "sse4", HWY_SSE4}, {SimdLevel::avx2, "avx2", HWY_AVX2}, {SimdLevel::avx512, "avx512", HWY_AVX3}}};

void use_targets_from(std::int64_t best) {
  hwy::DisableTargets(best - 1);  // all lower bits: every better target
}

/// @returns the best target in use: the lowest bit.
std::int64_t best_in_use() {
  const std::int64_t targets = hwy::SupportedTargets();
  return targets & -targets;
}

/// @returns the targets that the machine supports, independent of the current choice.
std::int64_t machine_targets() {
  const SimdLevelGuard guard;
  hwy::DisableTargets(0);
  return hwy::SupportedTargets();
}

std::string list_of(std::span<const SimdLevel> levels) {
  std::string out;
  for (const SimdLevel level : levels) out += (out.empty() ? "" : ", ") + std::string(name_of(level));
  return out.empty() ? "none" : out;
}

}  // namespace

std::string_view name_of(SimdLevel level) noexcept { return kLevels[static_cast<std::size_t>(level)].name; }

std::vector<SimdLevel> simd_levels() {
  const std::int64_t targets = machine_targets();
  std::vector<SimdLevel> out;
  for (const LevelInfo& info : kLevels)
    if ((targets & info.target) != 0) out.push_back(info.level);
  return out;
}

Result<std::optional<SimdLevel>> simd_level_named(std::string_view name, std::span<const SimdLevel> levels) {
  if (name == "auto") return std::optional<SimdLevel>();
  const auto info = std::ranges::find(kLevels, name, &LevelInfo::name);
  if (info == kLevels.end()) return bad_input("SIMD level \"" + std::string(name) + "\" must be one of: auto, sse4, avx2, avx512");
  if (std::ranges::find(levels, info->level) == levels.end())
    return bad_input("this machine has no " + std::string(name) + "; it has: " + list_of(levels));
  return std::optional(info->level);
}

Status choose_simd(std::string_view name) {
  const auto level = simd_level_named(name, simd_levels());
  if (!level) return level.error();
  if (level->has_value())
    use_targets_from(kLevels[static_cast<std::size_t>(**level)].target);
  else
    hwy::DisableTargets(0);
  return {};
}

SimdLevelGuard::SimdLevelGuard() noexcept : best_(best_in_use()) {}
SimdLevelGuard::~SimdLevelGuard() { use_targets_from(best_); }

std::string simd_in_use() {
  const std::int64_t targets = hwy::SupportedTargets();
  for (auto info = kLevels.rbegin(); info != kLevels.rend(); ++info)
    if ((targets & info->target) != 0) return std::string(info->name);
  return "portable";
}

}  // namespace burrhole
