#include "app/lab/stability_hand.h"

#include <algorithm>
#include <cmath>

#include "core/base/portable_math.h"
#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr int kStallTicks = 20;
constexpr std::uint64_t kJitterSeed = 1;

}  // namespace

StabilityHand::StabilityHand(const Setup& setup, SimulatedDevice device, const StabilityCase& of, bool sabotaged)
    : setup_(setup), device_(std::move(device)), case_(&of), sabotaged_(sabotaged) {}

Result<std::unique_ptr<StabilityHand>> StabilityHand::create(const Setup& setup, const StabilityCase& of, bool sabotaged) {
  auto device = SimulatedDevice::create(setup.device, setup.period);
  if (!device) return device.error();
  std::unique_ptr<StabilityHand> out(new StabilityHand(setup, std::move(device).value(), of, sabotaged));
  auto hand = DeviceHand::create(out->device_, setup.map);
  if (!hand) return hand.error();
  out->hand_.emplace(std::move(hand).value());
  const Vec3 velocity = setup.map.device(setup.map.world_from_device.translation + setup.world_from_approach.rotate(of.start_velocity));
  out->device_.place(out->grip_of(of.start), velocity);
  return out;
}

Vec3 StabilityHand::goal(double time) const noexcept {
  const std::vector<Waypoint>& path = case_->path;
  if (path.empty()) return case_->start;
  if (time <= path.front().time) return path.front().at;
  for (std::size_t n = 1; n < path.size(); ++n)
    if (time < path[n].time)
      return path[n - 1].at + (path[n].at - path[n - 1].at) * ((time - path[n - 1].time) / (path[n].time - path[n - 1].time));
  return path.back().at;
}

void StabilityHand::begin_tick(double time) noexcept {
  time_ = time;
  for (const Waypoint& jump : case_->trouble.teleports)
    if (std::abs(time - jump.time) < 0.5 * setup_.period) device_.place(grip_of(jump.at));
}

const HandState& StabilityHand::read() noexcept {
  reported_ = hand_->read();
  const StabilityTrouble& trouble = case_->trouble;
  if (trouble.hand_not_number && trouble.hand_not_number->holds(time_)) reported_.world_from_hand.translation.z = std::nan("");
  if (trouble.hand_infinite && trouble.hand_infinite->holds(time_)) reported_.velocity.x = std::numeric_limits<double>::infinity();
  return reported_;
}

int StabilityHand::ticks_until_next() noexcept {
  const StabilityTrouble& trouble = case_->trouble;
  ++tick_;
  if (trouble.servo_stall_every > 0.0 && tick_ % static_cast<std::uint64_t>(std::lround(trouble.servo_stall_every / setup_.period)) == 0)
    return kStallTicks;
  return 1 + static_cast<int>(uniform01(kJitterSeed, tick_) * (trouble.servo_jitter + 1));
}

Wrench StabilityHand::broken(const Wrench& wrench) noexcept {
  if (!sabotaged_) return wrench;
  const StabilitySabotage& sabotage = case_->sabotage;
  Wrench out = wrench;
  late_.push_back(wrench);
  if (late_.size() > static_cast<std::size_t>(sabotage.late) + 1) late_.pop_front();
  if (sabotage.late > 0) out = late_.front();
  if (sabotage.does_not_stop && out.force == Vec3(0.0)) out = strongest_;
  if (glm::length(out.force) > glm::length(strongest_.force)) strongest_ = out;
  if (sabotage.flip) out.force = -out.force;
  if (sabotage.turned != 0.0)
    out.force = Quat(portable_cos(0.5 * sabotage.turned), 0.0, portable_sin(0.5 * sabotage.turned), 0.0) * out.force;
  return out;
}

void StabilityHand::apply(const Wrench& on_hand) noexcept {
  const Wrench felt = broken(on_hand);
  device_.set_goal({grip_of(goal(time_)), Vec3(0.0)});
  felt_ = felt.force;
  hand_->apply(felt);
  alone_.clear();
  // If the servo is late, the device continues with its last force.
  for (int n = ticks_until_next(); n > 1; --n) {
    alone_.push_back(device_.grip());
    device_.write({setup_.map.to_grip(felt.force), Vec3(0.0)});
  }
}

}  // namespace burrhole
