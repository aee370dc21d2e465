#include "core/drill/engaged_removal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/drill/engaged_kernels.h"

namespace burrhole {
namespace {

constexpr float kLeastHardness = 0.1f;  // part of the laws, as in erosion.cpp

double hardness_of(const MasterWindow& window, std::size_t at) {
  return static_cast<double>(std::max(window.hardness[at], kLeastHardness));
}

constexpr std::size_t kBatch = 256;

}  // namespace

Result<EngagedRemoval> EngagedRemoval::create(const ErosionConfig& config, const ErosionPoints& points) {
  const auto above_zero = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (!(above_zero(config.energy.specific_energy) && above_zero(config.energy.cutting_ratio)))
    return Error{ErrorCode::out_of_range, "specific energy and cutting ratio must be numbers above 0", {}};
  return EngagedRemoval(config, points);
}

ErosionOutcome EngagedRemoval::step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt) {
  ErosionOutcome outcome;
  if (!(load.force > 0.0 && std::isfinite(load.force))) return outcome;
  const Affine& bone = voxmap.bone().bone_from_index();
  const double share = points_.pitch / bone.mean_edge(), cell_share = share * share * share;
  outcome.substeps = static_cast<std::uint32_t>(substeps);
  marks_.reset(voxmap.window().box);
  RubbingRadius mean;
  for (int n = 0; n < substeps; ++n) {
    engaged_.clear();
    outcome.outside += scatter_.gather(voxmap, points_, path.at((n + 0.5) / substeps), cell_share, engaged_);
    if (engaged_.empty()) continue;
    RubbingRadius now;
    for (const Engaged& one : engaged_) now.add(one);
    mean.add(now);
    const double work =
        cutting_torque(config_.energy.cutting_ratio, load.force, now.value()) * 2.0 * std::numbers::pi * load.spin * dt / substeps;
    const double removed = outcome.energy;
    apply(voxmap, turns(voxmap.window(), bone.cell_volume(), work), outcome);
    debt_ = std::max(0.0, debt_ + outcome.energy - removed - work);
  }
  outcome.removed_mass *= bone.cell_volume();
  outcome.changed = marks_.boxes();
  outcome.rubbing_radius = mean.value();
  return outcome;
}

double EngagedRemoval::turns(const MasterWindow& window, double cell_volume, double work) {
  terms_.clear();
  for (const Engaged& one : engaged_) {
    const double h = hardness_of(window, one.at);
    const double volume = static_cast<double>(window.occupancy[one.at]) * static_cast<double>(window.remaining[one.at]) * cell_volume;
    terms_.push_back({.worth = config_.energy.specific_energy * h * volume, .rate = static_cast<double>(one.exposure) / h});
  }
  return turns_for_work(terms_, work - debt_);
}

void EngagedRemoval::apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome) {
  if (!(turns > 0.0)) return;
  const MasterWindow& window = voxmap.window();
  const double cell_volume = voxmap.bone().bone_from_index().cell_volume();
  const std::span<float> bone = voxmap.remaining();
  VoxelsOfOffsets voxels(window.box);
  std::array<float, kBatch> available{}, exposure{}, hardness, left{};
  hardness.fill(1.0f);
  for (std::size_t from = 0; from < engaged_.size(); from += kBatch) {
    const std::size_t count = std::min(kBatch, engaged_.size() - from);
    for (std::size_t n = 0; n < count; ++n) {
      const Engaged& one = engaged_[from + n];
      available[n] = bone[one.at];
      exposure[n] = one.exposure;
      hardness[n] = std::max(window.hardness[one.at], kLeastHardness);
    }
    decay({count, turns, available.data(), exposure.data(), hardness.data(), left.data()});
    for (std::size_t n = 0; n < count; ++n) {
      const Engaged& one = engaged_[from + n];
      const float occupancy = window.occupancy[one.at], kept = occupancy * left[n] < config_.minimum_density ? 0.0f : left[n];
      float& remaining = bone[one.at];
      const float before = remaining;
      remaining = std::min(before, kept);
      if (remaining == before) continue;
      const double gone = static_cast<double>(occupancy) * (static_cast<double>(before) - static_cast<double>(remaining));
      outcome.removed_mass += gone;
      outcome.energy += gone * cell_volume * config_.energy.specific_energy * static_cast<double>(hardness[n]);
      const Vec3i v = voxels.at(one.at);
      marks_.mark({v.x & ~7, v.y, v.z}, 1u << (v.x & 7));
      ++outcome.touched;
    }
  }
}

}  // namespace burrhole
