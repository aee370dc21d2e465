#include "core/drill/face_removal.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr float kLeastDensity = 1e-3f;  // [-] a voxel that is thinned out ends here
constexpr float kTail = 0.25f;          // [voxel edges] way of the face over which bone beyond the ramp goes

/// @returns remaining [-] of a voxel without a face; the part of it inside the tool is thinned out.
float thinned(const MasterWindow& window, const Buried& node, double turns) noexcept {
  const float before = window.remaining[node.at], inside = CutFace::density_of(node.tool);
  const auto share = static_cast<float>(1.0 - portable_exp(-turns * static_cast<double>(node.wear)));
  const float after = before * (1.0f - inside * share);
  return window.occupancy[node.at] * after < kLeastDensity ? 0.0f : after;
}

/// @returns remaining [-] of a node's voxel when its face has moved to `phi`. Nothing is lost before the face moves: where the surface, when
/// the node was set, is steeper than the ramp, the ramp is scaled, and where it reaches further out than the ramp, the ramp reaches as far.
/// A voxel that had lost bone before has its ramp in `remaining`.
float remaining_at(const MasterWindow& window, const FaceNodes& nodes, std::size_t n, float phi) noexcept {
  const std::uint32_t at = nodes.at[n];
  const float base = nodes.base[n];
  const float before = window.remaining[at];
  const float ramp = std::max(CutFace::kRamp, base + kTail);
  if (phi <= nodes.cut[n] || phi <= -ramp) return before;
  const float occupancy = window.occupancy[at];
  if (occupancy == 0.0f) return before;
  const float at_base = CutFace::density_of(base, ramp);
  const bool is_face = at_base < 1.0f && nodes.cut_before[n] == 0;
  return std::min(before, CutFace::density_of(phi, ramp) / (is_face ? at_base : occupancy));
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
    if (face_.nodes().count == 0 && face_.buried().empty()) continue;
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

/// Adds the removal of one voxel. @param radius [m] from the tool's axis.
void FaceRemoval::add(const MasterWindow& window, std::uint32_t at, float before, float after, double radius, Sum& sum) const noexcept {
  const double gone = static_cast<double>(window.occupancy[at]) * static_cast<double>(before - after);
  sum.mass += gone;
  sum.moment += gone * radius;
  sum.energy += gone * config_.energy.specific_energy * static_cast<double>(std::max(window.hardness[at], CutFace::kLeastHardness));
}

template <class Use>
void FaceRemoval::for_each_loss(const MasterWindow& window, double turns, const Use& use) {
  const FaceNodes& nodes = face_.nodes();
  const std::span<const float> after = face_.recede(turns);
  for (std::size_t n = 0; n < after.size(); ++n) {
    const std::uint32_t at = nodes.at[n];
    const float left = remaining_at(window, nodes, n, after[n]);
    if (left != window.remaining[at]) use(at, left, face_.radius(n));
  }
}

FaceRemoval::Sum FaceRemoval::weigh(const MasterWindow& window, double turns) {
  Sum sum;
  const auto weigh_one = [&](std::uint32_t at, float left, double radius) { add(window, at, window.remaining[at], left, radius, sum); };
  for_each_loss(window, turns, weigh_one);
  for (const Buried& node : face_.buried()) weigh_one(node.at, thinned(window, node, turns), static_cast<double>(node.radius));
  return sum;
}

double FaceRemoval::turns_for(const MasterWindow& window, double cell_volume, double spin_time, double work) {
  const double wanted = work - debt_;
  if (!(trial_ > 0.0)) trial_ = spin_time;
  Sum sum = weigh(window, trial_);
  sum.energy *= cell_volume;
  if (const std::size_t count = face_.nodes().count; radius_ == 0.0 && count > 0) {
    for (std::size_t n = 0; n < count; ++n) radius_ += face_.radius(n);
    radius_ /= static_cast<double>(count);
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
  const auto write = [&](std::uint32_t at, float left, double radius) {
    const float before = std::exchange(bone[at], left);
    if (left == before) return;
    add(window, at, before, left, radius, sum);
    const Vec3i v(static_cast<int>(at % row), static_cast<int>(at % slab / row), static_cast<int>(at / slab));
    marks_.mark({v.x & ~7, v.y, v.z}, 1u << (v.x & 7));
    ++outcome.touched;
  };
  for_each_loss(window, turns, write);
  face_.keep();
  bool open = false;
  for (const Buried& node : face_.buried()) {
    write(node.at, thinned(window, node, turns), static_cast<double>(node.radius));
    open = open || window.occupancy[node.at] * bone[node.at] < 0.5f;
  }
  if (open) face_.open();
  return sum;
}

}  // namespace burrhole
