#include "core/drill/progressive_removal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/drill/projected_area.h"

namespace burrhole {
namespace {

constexpr float kLeastHardness = 0.1f;

bool in_share(double x) { return x > 0.0 && x <= 1.0; }

}  // namespace

double level_of_work(std::vector<WorkTaker>& takers, double work) {
  std::sort(takers.begin(), takers.end(), [](const WorkTaker& a, const WorkTaker& b) {
    const double first = a.capacity / a.weight, second = b.capacity / b.weight;
    return first != second ? first < second : a.at < b.at;
  });
  double weight = 0.0, level = 0.0;
  for (const WorkTaker& taker : takers) weight += taker.weight;
  for (const WorkTaker& taker : takers) {
    const double full = taker.capacity / taker.weight;
    const double step = (full - level) * weight;  // brings all that are left to where this one is full
    if (work <= step) return level + work / weight;
    work -= step;
    level = full;
    weight -= taker.weight;
  }
  return level;
}

Result<ProgressiveRemoval> ProgressiveRemoval::create(const ErosionConfig& config, const ErosionPoints& points) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!in_share(config.progressive.bearing_share) || !in_share(config.progressive.work_share))
    return refuse("bearing share and work share of law \"progressive\" must be in (0, 1]");
  if (!(config.energy.cutting_ratio > 0.0 && std::isfinite(config.energy.cutting_ratio)))
    return refuse("the cutting ratio must be above 0");
  return ProgressiveRemoval(config, points);
}

double ProgressiveRemoval::specific_work(float hardness) const noexcept {
  return static_cast<double>(std::max(hardness, kLeastHardness)) * config_.progressive.curve.toughness() / config_.progressive.work_share;
}

double ProgressiveRemoval::limit(float hardness, double stress) const noexcept {
  return config_.progressive.curve.damage_at(stress / static_cast<double>(std::max(hardness, kLeastHardness)));
}

double ProgressiveRemoval::stress_on(const Voxmap& voxmap, const Affine& index_from_tool, const CuttingLoad& load) {
  if (engaged_.empty()) return 0.0;
  const Affine& bone_from_index = voxmap.bone().bone_from_index();
  VoxelsOfOffsets voxels(voxmap.window().box);
  places_.clear();
  for (const Engaged& one : engaged_) places_.push_back(bone_from_index.linear * Vec3(voxels.at(one.at)));
  const Vec3 along = bone_from_index.linear * (index_from_tool.linear * load.reaction);
  return load.force /
         (config_.progressive.bearing_share * projected_area(places_, glm::normalize(along), bone_from_index.mean_edge(), cells_));
}

double ProgressiveRemoval::find_takers(const Voxmap& voxmap, double stress) {
  const MasterWindow& window = voxmap.window();
  const double cell = voxmap.bone().bone_from_index().cell_volume();
  RubbingRadius radius;
  takers_.clear();
  for (const Engaged& one : engaged_) {
    const double volume = cell * static_cast<double>(window.occupancy[one.at]);
    const double further = limit(window.hardness[one.at], stress) - (1.0 - static_cast<double>(window.remaining[one.at]));
    if (!(volume > 0.0 && further > 0.0)) continue;
    takers_.push_back({one.at, static_cast<double>(one.exposure) * volume, further * volume * specific_work(window.hardness[one.at])});
    radius.add(one);
  }
  return radius.value();
}

void ProgressiveRemoval::remove(Voxmap& voxmap, double stress, double work, ErosionOutcome& outcome) {
  const MasterWindow& window = voxmap.window();
  const double cell = voxmap.bone().bone_from_index().cell_volume();
  const std::span<float> bone = voxmap.remaining();
  VoxelsOfOffsets voxels(window.box);
  const double level = level_of_work(takers_, work);
  for (const WorkTaker& taker : takers_) {
    const float hardness = window.hardness[taker.at], before = bone[taker.at];
    const double volume = cell * static_cast<double>(window.occupancy[taker.at]);
    const double received = std::min(taker.capacity, level * taker.weight);
    const auto after = received < taker.capacity
                           ? static_cast<float>(static_cast<double>(before) - received / (volume * specific_work(hardness)))
                           : static_cast<float>(1.0 - limit(hardness, stress));
    if (!(after < before)) continue;  // less than a float can hold
    bone[taker.at] = after;
    const double mass = volume * (static_cast<double>(before) - static_cast<double>(after));
    outcome.removed_mass += mass;
    outcome.energy += mass * specific_work(hardness);
    const Vec3i inside = voxels.at(taker.at);
    marks_.mark({inside.x & ~7, inside.y, inside.z}, 1u << (inside.x & 7));
    ++outcome.touched;
  }
}

ErosionOutcome ProgressiveRemoval::step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt) {
  ErosionOutcome outcome;
  if (!(load.force > 0.0 && std::isfinite(load.force))) return outcome;
  const double pitch = points_.pitch / voxmap.bone().bone_from_index().mean_edge();
  outcome.substeps = static_cast<std::uint32_t>(substeps);
  marks_.reset(voxmap.window().box);
  for (int n = 0; n < substeps; ++n) {
    const Affine at = path.at((n + 0.5) / substeps);
    engaged_.clear();
    outcome.outside += scatter_.gather(voxmap, points_, at, pitch * pitch * pitch, engaged_);
    const double stress = stress_on(voxmap, at, load);
    outcome.stress = std::max(outcome.stress, stress);
    const double radius = find_takers(voxmap, stress);
    if (radius > 0.0) outcome.rubbing_radius = radius;
    const double speed = 2.0 * std::numbers::pi * load.spin * radius;
    remove(voxmap, stress, config_.energy.cutting_ratio * load.force * speed * dt / substeps, outcome);
  }
  outcome.changed = marks_.boxes();
  return outcome;
}

}  // namespace burrhole
