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

Affine pose_at(const ErosionPath& path, double t) {
  return {path.from.linear + (path.to.linear - path.from.linear) * t, path.from.offset + (path.to.offset - path.from.offset) * t};
}

/// Index coordinates of voxels from their offsets; fast for consecutive voxels of one row.
class Voxels {
 public:
  explicit Voxels(const VoxelBox& box) noexcept
      : row_(static_cast<std::size_t>(box.size().x)), slab_(row_ * static_cast<std::size_t>(box.size().y)) {}
  /// Relative to the box.
  [[nodiscard]] Vec3i at(std::size_t n) noexcept {
    if (n - start_ >= row_) {  // also true for offsets before the row: the difference wraps
      y_ = static_cast<int>(n % slab_ / row_);
      z_ = static_cast<int>(n / slab_);
      start_ = n - n % row_;
    }
    return {static_cast<int>(n - start_), y_, z_};
  }

 private:
  std::size_t row_, slab_, start_ = 0;
  int y_ = 0, z_ = 0;
};

constexpr std::size_t kBatch = 256;

}  // namespace

Result<EngagedRemoval> EngagedRemoval::create(const ErosionConfig& config, const ErosionPoints& points,
                                              std::shared_ptr<const CuttingField> field) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  const auto above_zero = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (config.subvoxel && config.law == ErosionLaw::per_update) return refuse("sub-voxel removal needs law rate or law energy");
  if (config.subvoxel && field == nullptr) return refuse("sub-voxel removal needs the cutting field of its tool");
  if (config.law == ErosionLaw::energy && !(above_zero(config.energy.specific_energy) && above_zero(config.energy.cutting_ratio)))
    return refuse("specific energy and cutting ratio must be numbers above 0");
  EngagedRemoval removal(config, points);
  if (config.subvoxel) removal.coverage_.emplace(std::move(field), config.kernel);
  return removal;
}

ErosionOutcome EngagedRemoval::step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt) {
  ErosionOutcome outcome;
  const bool by_energy = config_.law == ErosionLaw::energy;
  if (by_energy && !(load.force > 0.0 && std::isfinite(load.force))) return outcome;
  const Affine& bone = voxmap.bone().bone_from_index();
  const double share = points_.pitch / bone.mean_edge(), cell_share = share * share * share;
  outcome.substeps = static_cast<std::uint32_t>(substeps);
  marks_.reset(voxmap.window().box);
  RubbingRadius mean;
  for (int n = 0; n < substeps; ++n) {
    engaged_.clear();
    const double start = static_cast<double>(n) / substeps, end = static_cast<double>(n + 1) / substeps;
    outcome.outside += coverage_ ? coverage_->advance(voxmap, {pose_at(path, start), pose_at(path, end)}, engaged_)
                                 : scatter_.gather(voxmap, points_, pose_at(path, 0.5 * (start + end)), cell_share, engaged_);
    if (engaged_.empty()) continue;
    RubbingRadius now;
    for (const Engaged& one : engaged_) now.add(one);
    mean.add(now);
    const double time = dt / substeps;
    const double work = cutting_torque(config_.energy.cutting_ratio, load.force, now.value()) * 2.0 * std::numbers::pi * load.spin * time;
    const double removed = outcome.energy;
    apply(voxmap, turns(voxmap.window(), bone.cell_volume(), load.spin * time, work), outcome);
    if (by_energy) debt_ = std::max(0.0, debt_ + outcome.energy - removed - work);
  }
  outcome.removed_mass *= bone.cell_volume();
  outcome.changed = marks_.boxes();
  outcome.rubbing_radius = mean.value();
  return outcome;
}

double EngagedRemoval::turns(const MasterWindow& window, double cell_volume, double spin_time, double work) {
  if (config_.law == ErosionLaw::rate) return spin_time;
  terms_.clear();
  for (const Engaged& one : engaged_) {
    const double h = hardness_of(window, one.at);
    const double volume = static_cast<double>(window.occupancy[one.at]) * static_cast<double>(one.available) * cell_volume;
    terms_.push_back({.worth = config_.energy.specific_energy * h * volume, .rate = static_cast<double>(one.exposure) / h});
  }
  return turns_for_work(terms_, work - debt_);
}

void EngagedRemoval::apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome) {
  if (!(turns > 0.0)) return;
  const MasterWindow& window = voxmap.window();
  const double cell_volume = voxmap.bone().bone_from_index().cell_volume();
  const std::span<float> bone = voxmap.remaining();
  Voxels voxels(window.box);
  std::array<float, kBatch> available{}, exposure{}, hardness, left{};
  hardness.fill(1.0f);
  for (std::size_t from = 0; from < engaged_.size(); from += kBatch) {
    const std::size_t count = std::min(kBatch, engaged_.size() - from);
    for (std::size_t n = 0; n < count; ++n) {
      const Engaged& one = engaged_[from + n];
      available[n] = one.available;
      exposure[n] = one.exposure;
      hardness[n] = std::max(window.hardness[one.at], kLeastHardness);
    }
    decay({count, turns, available.data(), exposure.data(), hardness.data(), left.data()});
    for (std::size_t n = 0; n < count; ++n) {
      const Engaged& one = engaged_[from + n];
      const float least = one.share < 1.0f ? std::max(config_.minimum_density, config_.clear_below) : config_.minimum_density;
      const float occupancy = window.occupancy[one.at], kept = occupancy * left[n] < least * one.share ? 0.0f : left[n];
      float& remaining = bone[one.at];
      const float before = remaining;
      remaining = std::min(before, (before - one.available) + kept);
      if (remaining == before) continue;
      const double gone = static_cast<double>(occupancy) * (static_cast<double>(before) - static_cast<double>(remaining));
      outcome.removed_mass += gone;
      if (config_.law == ErosionLaw::energy)
        outcome.energy += gone * cell_volume * config_.energy.specific_energy * static_cast<double>(hardness[n]);
      const Vec3i v = voxels.at(one.at);
      marks_.mark({v.x & ~7, v.y, v.z}, 1u << (v.x & 7));
      ++outcome.touched;
    }
  }
}

}  // namespace burrhole
