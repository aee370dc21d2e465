#include "core/drill/face_removal.h"

#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr float kLeastDensity = 1e-3f;  // [-] a voxel that is thinned out ends here
constexpr float kTail = 0.25f;          // [voxel edges] way of the face over which bone beyond the ramp goes

template <class Node>
float share_of(const Node& node, double turns) noexcept {
  return static_cast<float>(1.0 - portable_exp(-turns * static_cast<double>(node.rule.factor) / static_cast<double>(node.rule.hardness)));
}

/// @returns remaining [-] of a voxel without a face; the part of it inside the tool is thinned out.
float thinned(const MasterWindow& window, const Buried& node, double turns) noexcept {
  const float before = window.remaining[node.at], inside = CutFace::density_of(node.tool);
  const float after = before * (1.0f - inside * share_of(node, turns));
  return window.occupancy[node.at] * after < kLeastDensity ? 0.0f : after;
}

/// @returns remaining [-] of a voxel whose face is at phi. Nothing is lost before the face moves: where the surface as loaded is steeper than
/// the ramp, the ramp is scaled, and where it reaches further out than the ramp, the ramp reaches as far.
float remaining_at(const MasterWindow& window, const Receding& node, float phi) noexcept {
  const float before = window.remaining[node.at], occupancy = window.occupancy[node.at];
  if (occupancy == 0.0f || phi <= node.node->cut) return before;
  const float ramp = std::max(CutFace::kRamp, node.node->base + kTail), loaded = CutFace::density_of(node.node->base, ramp);
  return std::min(before, CutFace::density_of(phi, ramp) / (loaded < 1.0f ? loaded : occupancy));
}

}  // namespace

Result<FaceRemoval> FaceRemoval::create(const ErosionConfig& config, std::shared_ptr<const CuttingField> field) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  const auto above_zero = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (config.law == ErosionLaw::per_update) return refuse("sub-voxel removal needs law rate or law energy");
  if (field == nullptr) return refuse("sub-voxel removal needs the cutting field of its tool");
  if (config.law == ErosionLaw::energy && !(above_zero(config.energy.specific_energy) && above_zero(config.energy.cutting_ratio)))
    return refuse("specific energy and cutting ratio must be numbers above 0");
  return FaceRemoval(config, std::move(field));
}

ErosionOutcome FaceRemoval::step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt) {
  ErosionOutcome outcome;
  const bool by_energy = config_.law == ErosionLaw::energy;
  if (by_energy && !(load.force > 0.0 && std::isfinite(load.force))) return outcome;
  const double cell = voxmap.bone().bone_from_index().cell_volume();
  outcome.substeps = static_cast<std::uint32_t>(substeps);
  marks_.reset(voxmap.window().box);
  const double time = dt / substeps;
  double moment = 0.0;
  for (int n = 0; n < substeps; ++n) {
    outcome.outside += face_.find(voxmap, path.at((n + 1.0) / substeps), load.reaction);
    if (face_.nodes().empty() && face_.buried().empty()) continue;
    double turns = load.spin * time, work = 0.0;
    if (by_energy) {
      work = cutting_torque(config_.energy.cutting_ratio, load.force, radius_) * 2.0 * std::numbers::pi * load.spin * time;
      turns = turns_for(voxmap.window(), cell, turns, work);
    }
    const Sum sum = apply(voxmap, turns, outcome);
    moment += sum.moment;
    if (by_energy) debt_ = std::max(-work, debt_ + sum.energy * cell - work);
    outcome.energy += sum.energy * cell;
    outcome.removed_mass += sum.mass * cell;
    if (sum.mass > 0.0) radius_ = sum.moment / sum.mass;
  }
  outcome.changed = marks_.boxes();
  outcome.rubbing_radius = outcome.removed_mass > 0.0 ? moment * cell / outcome.removed_mass : radius_;
  return outcome;
}

std::span<const float> FaceRemoval::recede(double turns) {
  shares_.clear();
  shares_.reserve(face_.reserved());
  for (const Receding& node : face_.nodes()) shares_.push_back(share_of(node, turns));
  return face_.recede(shares_);
}

/// Adds the removal of one voxel.
template <class Node>
void FaceRemoval::add(const MasterWindow& window, const Node& node, float before, float after, Sum& sum) const noexcept {
  const double gone = static_cast<double>(window.occupancy[node.at]) * static_cast<double>(before - after);
  sum.mass += gone;
  sum.moment += gone * static_cast<double>(node.rule.radius);
  sum.energy += gone * config_.energy.specific_energy * static_cast<double>(node.rule.hardness);
}

FaceRemoval::Sum FaceRemoval::weigh(const MasterWindow& window, double turns) {
  Sum sum;
  const std::span<const float> after = recede(turns);
  for (std::size_t n = 0; n < after.size(); ++n) {
    const Receding& node = face_.nodes()[n];
    add(window, node, window.remaining[node.at], remaining_at(window, node, after[n]), sum);
  }
  for (const Buried& node : face_.buried()) add(window, node, window.remaining[node.at], thinned(window, node, turns), sum);
  return sum;
}

double FaceRemoval::turns_for(const MasterWindow& window, double cell_volume, double spin_time, double work) {
  const double wanted = work - debt_;
  if (!(trial_ > 0.0)) trial_ = spin_time;
  Sum sum = weigh(window, trial_);
  sum.energy *= cell_volume;
  if (radius_ == 0.0 && !face_.nodes().empty()) {
    for (const Receding& node : face_.nodes()) radius_ += static_cast<double>(node.rule.radius);
    radius_ /= static_cast<double>(face_.nodes().size());
  }
  if (!(wanted > 0.0)) return 0.0;
  // Removal grows with k, and less than in proportion to it.
  trial_ = std::min(sum.energy > 0.0 ? trial_ * wanted / sum.energy : 10.0 * trial_, 1e3 * spin_time);
  return trial_;
}

FaceRemoval::Sum FaceRemoval::apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome) {
  const MasterWindow& window = voxmap.window();
  const std::span<float> bone = voxmap.remaining();
  const Vec3i size = window.box.size();
  const auto row = static_cast<std::size_t>(size.x), slab = row * static_cast<std::size_t>(size.y);
  Sum sum;
  if (!(turns > 0.0)) return sum;
  const auto write = [&](const auto& node, float left) {
    const float before = bone[node.at];
    if (left == before) return;
    bone[node.at] = left;
    add(window, node, before, left, sum);
    const Vec3i v(static_cast<int>(node.at % row), static_cast<int>(node.at % slab / row), static_cast<int>(node.at / slab));
    marks_.mark({v.x & ~7, v.y, v.z}, 1u << (v.x & 7));
    ++outcome.touched;
  };
  const std::span<const float> after = recede(turns);
  for (std::size_t n = 0; n < after.size(); ++n) {
    const Receding& node = face_.nodes()[n];
    write(node, remaining_at(window, node, after[n]));
  }
  face_.keep();
  bool open = false;
  for (const Buried& node : face_.buried()) {
    write(node, thinned(window, node, turns));
    open = open || window.occupancy[node.at] * bone[node.at] < 0.5f;
  }
  if (open) face_.open();
  return sum;
}

}  // namespace burrhole
