#include "haptics/servo/servo_step.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace burrhole {
namespace {

constexpr double kNothing = 1e-6;  // [N] rounding of a tool without contact; the friction of a device is 1e4 times this

bool is_finite(const HandState& hand) noexcept {
  const Quat& q = hand.world_from_hand.rotation;
  return burrhole::is_finite(hand.world_from_hand.translation) && burrhole::is_finite(hand.velocity) && std::isfinite(hand.thrust) &&
         std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}

}  // namespace

const char* name_of(ServoFault fault) noexcept {
  switch (fault) {
    case kServoForceNotFinite:
      return "force not finite";
    case kServoForceCapped:
      return "force capped";
    case kServoSlewLimited:
      return "force change limited";
    case kServoHandNotFinite:
      return "hand not finite";
    case kServoHandLost:
      return "hand lost";
    case kServoContactStale:
      return "contact stale";
    case kServoEnergy:
      return "energy generated";
    case kServoStopped:
      return "stopped";
    case kServoDamped:
      return "damped";
    case kServoHandJumped:
      return "hand jumped";
    case kServoSwinging:
      return "force in a limit cycle";
  }
  return "unknown";
}

Status check(const ServoConfig& config) {
  struct Named {
    const char* name;
    double value;
  };
  const auto refuse = [](const char* name, const char* range) {
    return Error{ErrorCode::out_of_range, std::string("servo: ") + name + " must be " + range, {}};
  };
  const Named above_zero[] = {{"period", config.period}, {"largest_force", config.largest_force}};
  for (const Named& named : above_zero)
    if (!(named.value > 0.0 && std::isfinite(named.value))) return refuse(named.name, "finite and above 0");
  if (!(config.multi_rate.max_distance > 0.0)) return refuse("max_distance", "above 0");
  if (config.energy.delay < 0 || config.energy.delay > kMaxEnergyDelay) return refuse("energy.delay", "from 0 to 31");
  if (config.multi_rate.contact_ticks < 1) return refuse("contact_ticks", "at least 1");
  if (!(config.largest_slew >= 0.0)) return refuse("largest_slew", "at least 0");
  const Named not_below_zero[] = {{"soft_start", config.soft_start},
                                  {"soft_stop", config.soft_stop},
                                  {"jump_speed", config.jump_speed},
                                  {"energy.damping", config.energy.damping},
                                  {"energy.tolerance", config.energy.tolerance},
                                  {"swing.force", config.swing.force},
                                  {"swing.longest", config.swing.longest},
                                  {"energy.largest_damping", config.energy.largest_damping}};
  for (const Named& named : not_below_zero)
    if (!(named.value >= 0.0 && std::isfinite(named.value))) return refuse(named.name, "finite and at least 0");
  return {};
}

ServoStep::ServoStep(const ServoConfig& config, HandSource& hand, TripleBuffer<ContactState>& contact_in,
                     TripleBuffer<HandState>& hand_out) noexcept
    : config_(config),
      hand_(&hand),
      contact_in_(&contact_in),
      hand_out_(&hand_out),
      multi_rate_(config.multi_rate),
      energy_(config.energy, config.period),
      swings_(config.swing, config.period),
      slew_(config.largest_slew * config.period),
      gain_(config.soft_start, config.soft_stop, config.period) {}

void ServoStep::read_hand() noexcept {
  const HandState& read = hand_->read();
  hand_age_ = counts_.ticks > 0 && read.tick == output_.hand.tick ? hand_age_ + 1 : 0;
  hand_faults_ = 0;
  jumped_ = false;
  if (is_finite(read) && (read.flags & kHandNotFinite) == 0) {
    const double ticks = static_cast<double>(read.tick - std::min(read.tick, output_.hand.tick));
    const double moved = glm::length(read.world_from_hand.translation - output_.hand.world_from_hand.translation);
    jumped_ = counts_.ticks > 0 && config_.jump_speed > 0.0 && moved > config_.jump_speed * config_.period * std::max(1.0, ticks);
    output_.hand = read;
  } else {
    // A motion that is not finite stops here: contact and erosion receive the last finite motion, at rest.
    output_.hand.velocity = Vec3(0.0);
    output_.hand.tick = read.tick;
    output_.hand.flags = read.flags | kHandNotFinite;
    hand_faults_ |= kServoHandNotFinite;
  }
  const double spin = read.spin * spin_.load(std::memory_order_relaxed);
  if (spin != spin_before_) hand_->drive_changed();
  output_.hand.spin = spin_before_ = spin;
  output_.hand.switches = read.switches | switches_.load(std::memory_order_relaxed);
  if ((faults_ & (kServoLatched | kServoStopped)) != 0) output_.hand.flags |= kHandUnopposed;
  if ((read.flags & kHandLost) != 0 || (config_.max_hand_age > 0 && hand_age_ > config_.max_hand_age)) hand_faults_ |= kServoHandLost;
}

const HandState& ServoStep::sense() noexcept {
  read_hand();
  hand_out_->publish(output_.hand);
  return output_.hand;
}

void ServoStep::latch(std::uint32_t fault) noexcept {
  if ((fault & ~faults_) == 0) return;
  faults_ |= fault;
  ++counts_.latched;
}

bool ServoStep::reset() noexcept {
  if (hand_faults_ != 0 || !burrhole::is_finite(contact_in_->latest().on_hand.force)) return false;
  faults_ &= ~(kServoLatched | kServoStopped);
  energy_.clear();
  restart_softly();
  return true;
}

void ServoStep::restart() noexcept {
  restart_softly();
  kept_ = output_.force;
  kept_added_ = added_;
  kept_share_ = config_.soft_start > 0.0 && kept_ != Vec3(0.0) ? 1.0 : 0.0;
}

void ServoStep::restart_softly() noexcept {
  multi_rate_.clear();
  slew_.clear();
  slewed_added_ = Vec3(0.0);
  gain_.cut();
  kept_share_ = 0.0;
  soft_since_ = output_.hand.tick;
}

void ServoStep::apply_requests() noexcept {
  if (reset_requested_.exchange(false, std::memory_order_relaxed)) reset();
  if (stop_requested_.exchange(false, std::memory_order_relaxed)) faults_ |= kServoStopped;
}

void ServoStep::watch(const ContactState& contact) noexcept {
  latch(hand_faults_);
  if (jumped_) {
    faults_ |= kServoHandJumped;
    ++counts_.jumped;
    energy_.jump();
    restart_softly();
  }
  if (output_.gain < 1.0) energy_.jump();  // a wall whose force is ramped up generates energy by design
  energy_(output_.hand.world_from_hand.translation, output_.hand.velocity, output_.force);
  if (energy_.fault()) latch(kServoEnergy);
  output_.contact_number = contact.number;
  contact_tick_ = contact.tick;
  output_.contact_age = contact.number > 0 && output_.hand.tick > contact.tick ? output_.hand.tick - contact.tick : 0;
  if (config_.max_contact_age > 0 && output_.contact_age > config_.max_contact_age) {
    faults_ |= kServoContactStale;
    ++counts_.stale;
    soft_since_ = output_.hand.tick;
  }
}

Vec3 ServoStep::fading() noexcept {
  if (kept_share_ <= 0.0) return Vec3(0.0);
  kept_share_ = std::max(0.0, kept_share_ - config_.period / config_.soft_start);
  return kept_ * kept_share_;
}

Vec3 ServoStep::limited(Vec3 force, Vec3 added) noexcept {
  const Vec3 damping = energy_.damping_force();
  if (damping != Vec3(0.0)) {
    force += damping;
    faults_ |= kServoDamped;
    ++counts_.damped;
  }
  // The cap comes first: a slew limit that starts above the cap would keep the output at the cap long after the requested force has
  // dropped.
  const Vec3 capped = shortened(force, config_.largest_force);
  if (capped != force) {
    added *= glm::length(capped) / glm::length(force);
    faults_ |= kServoForceCapped;
    ++counts_.capped;
  }
  const Vec3 shown = slew_(capped);
  slewed_added_ = slew_.limited() ? slewed_added_ + slew_.share() * (added - slewed_added_) : added;
  if (slew_.limited()) {
    faults_ |= kServoSlewLimited;
    ++counts_.slewed;
  }
  const bool on = (faults_ & (kServoContactStale | kServoStopped)) == 0;
  const double gain = gain_(on);
  // A step of the force is impossible where the force is zero, if contact used the current place of the hand.
  const bool free = kept_share_ <= 0.0 && glm::length(output_.wanted) <= kNothing;
  if (on && output_.contact_number > 0 && contact_tick_ >= soft_since_ && free) gain_.open();
  const Vec3 kept = fading();
  added_ = slewed_added_ * gain + kept_added_ * kept_share_;
  return shown * gain + kept;
}

const ServoOutput& ServoStep::act(const Vec3& added) noexcept {
  apply_requests();
  faults_ &= kServoLatched | kServoStopped;  // other bits are set again in each tick
  const ContactState& contact = contact_in_->latest();
  watch(contact);
  output_.wanted = multi_rate_timer_([&] { return multi_rate_(contact, output_.hand, config_.period).force; });
  if (added != Vec3(0.0)) output_.wanted += added;
  if (!burrhole::is_finite(output_.wanted) || !burrhole::is_finite(contact.on_hand.force)) {
    output_.wanted = Vec3(0.0);
    latch(kServoForceNotFinite);
  }
  if ((faults_ & kServoLatched) != 0) {
    slew_.clear();
    gain_.cut();
    kept_share_ = 0.0;
    output_.force = slewed_added_ = added_ = Vec3(0.0);
  } else {
    output_.force = limited(output_.wanted, added);
  }
  if (swings_(output_.force)) {
    faults_ |= kServoSwinging;
    ++counts_.swinging;
  }
  largest_output_ = std::max(largest_output_, glm::length(output_.force));
  output_.gain = gain_.gain();
  output_.faults = faults_;
  ++counts_.ticks;
  if (contact.number > 0) hand_->drill_at(contact.bone.world_from_rest.inverse() * contact.world_from_tool.translation);
  if (added_ != Vec3(0.0)) hand_->added_force(added_);
  hand_->apply({output_.force, Vec3(0.0)});
  return output_;
}

}  // namespace burrhole
