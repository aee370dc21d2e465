#include "core/debris/debris_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"
#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr double kFlightStep = 1e-3;  // [s] of the flight, in steps of which a long step is divided
constexpr double kMostFlightSteps = 128.0;
constexpr double kMistQuantum = 0.1;    // [-] volume of a particle of mist over one of chips
constexpr double kMostPerStep = 64.0;   // new particles of a kind in a step; beyond it they are larger
constexpr double kRinsedWhole = 1e-3;   // [-] of a new particle, below which the rest is rinsed as well
constexpr std::size_t kLeastFreed = 8;  // a merge that frees less than this part of the budget is not tried again until the bit stands
constexpr int kMostClimbs = 16;         // cells that a chip climbs over a full heap
constexpr double kSlideTime = 1.0;      // [s] in which a settled heap finds its slope (an assumption)
constexpr double kSpeedSpread = 0.5;    // [-] of the thrown speed, either way (an assumption)
constexpr int kMostMouthSteps = 512;    // half voxels up the shaft: beyond any hole

}  // namespace

DebrisField::DebrisField(const DebrisConfig& config, DebrisSite site) : config_(config), site_(std::move(site)), quantum_(config.particle) {
  particles_.reserve(config.most_particles);
  seats_.reserve(config.most_particles);
  first_.assign(site_.cells(), kNone);
}

Result<DebrisField> DebrisField::create(const DebrisConfig& config, DebrisSite site) {
  const auto above = [](double value, double least) { return std::isfinite(value) && value > least; };
  const auto least = [](double value, double least_value) { return std::isfinite(value) && value >= least_value; };
  const ChipAir& air = config.air;
  const bool fits = config.most_particles >= 1 && config.most_particles < kNone && above(config.particle, 0.0) &&
                    above(config.chip_ratio, 0.0) && above(config.smallest, 0.0) && least(config.largest, config.smallest) &&
                    least(config.size_spread, 1.0) && above(config.clearing, 0.0) && least(config.throw_share, 0.0) &&
                    least(config.spread, 0.0) && least(config.mist_share, 0.0) && config.mist_share <= 1.0 &&
                    above(config.mist_diameter, 0.0) && least(config.mist_cloud, 0.0) && least(config.bulk, 1.0) &&
                    above(config.rinse_time, 0.0) && least(config.rinse_load, 0.0) && above(air.chip_density, 0.0) &&
                    above(air.air_density, 0.0) && above(air.viscosity, 0.0) && least(air.gravity, 0.0);
  if (!fits) return Error{ErrorCode::out_of_range, "chips: a value of the config is out of range", {}};
  return DebrisField(config, std::move(site));
}

std::uint64_t DebrisField::bytes_of(const DebrisConfig& config, std::uint64_t cells) noexcept {
  return config.most_particles * (sizeof(DebrisParticle) + sizeof(Seat)) + cells * sizeof(std::uint32_t);
}

double DebrisField::random() noexcept { return uniform01(config_.seed, drawn_++); }

void DebrisField::step(const DebrisStep& now) noexcept {
  totals_.removed += now.removed;
  if (!now.births.empty()) {
    birth_count_ = std::min(now.births.size(), births_.size());
    std::copy_n(now.births.begin(), birth_count_, births_.begin());
  }
  if (now.thickness > 0.0) thickness_ = now.thickness;
  if (now.bit.spin > 0.0) {
    take_up(now.bit);
    release(now);
  } else {
    held_ += now.removed;
    if (holds_ || now.removed > 0.0) drop(now);
  }
  holds_ = now.bit.spin > 0.0;
  merged_now_ = merged_now_ && holds_;
  site_.set_bit(now.bit.tip, now.bit.axis, now.bit.radius);
  loosen();
  slide(now.dt);
  fly(now.dt);
  if (now.rinse.flow > 0.0) rinse(now.rinse, now.dt);
  if (now.suction.flow > 0.0) suck(now.suction);
  refill();
  most_ = std::max(most_, particles_.size());
}

void DebrisField::release(const DebrisStep& now) noexcept {
  const double kept = held_after(held_, now.removed, config_.clearing * now.bit.spin * now.dt);
  const double out = std::max(0.0, held_ + now.removed - kept);
  held_ = held_ + now.removed - out;
  waiting_mist_ += config_.mist_share * out;
  waiting_chips_ += out - config_.mist_share * out;
  emit(waiting_chips_, quantum_, now, false);
  emit(waiting_mist_, kMistQuantum * quantum_, now, true);
}

void DebrisField::emit(double& waiting, double quantum, const DebrisStep& now, bool is_mist) noexcept {
  const double volume = std::max(quantum, waiting / kMostPerStep);
  while (waiting >= volume) {
    DebrisParticle one = born(now, is_mist);
    one.volume = volume;
    waiting -= volume;
    add(one);
  }
}

DebrisParticle DebrisField::born(const DebrisStep& now, bool is_mist) noexcept {
  const double angle = 2.0 * std::numbers::pi * random();
  const Quat from_bit = rotation_from_z(now.bit.axis);
  const Vec3 outwards = from_bit * Vec3(portable_cos(angle), portable_sin(angle), 0.0);
  DebrisParticle one{.position = mouth(now.bit, outwards), .is_mist = is_mist};
  one.number = numbers_++;
  one.birth.left = 255;  // of a place that is not known
  if (birth_count_ > 0) one.birth = births_[static_cast<std::size_t>(random() * static_cast<double>(birth_count_))];
  if (is_mist) {
    one.diameter = config_.mist_diameter;
    const Vec3 shift(2.0 * random() - 1.0, 2.0 * random() - 1.0, random());
    const Vec3 place = one.position + config_.mist_cloud * (from_bit * shift);
    if (site_.contains(place)) one.position += (place - one.position) * site_.free_share(one.position, place);
    return one;
  }
  const double mean = std::clamp(config_.chip_ratio * thickness_, config_.smallest, config_.largest);
  one.diameter = mean * portable_exp(portable_log(config_.size_spread) * (2.0 * random() - 1.0));
  diameters_ += one.diameter;
  ++made_;
  const double rim = 2.0 * std::numbers::pi * now.bit.spin * now.bit.radius;
  const double speed = config_.throw_share * rim * (1.0 + kSpeedSpread * (2.0 * random() - 1.0));
  const Vec3 along = glm::cross(now.bit.axis, outwards);
  const Vec3 direction = along + config_.spread * (random() * outwards + random() * now.bit.axis);
  one.velocity = speed * glm::normalize(direction);
  return one;
}

Vec3 DebrisField::mouth(const DebrisBit& bit, const Vec3& outwards) const noexcept {
  const Vec3 rim = bit.tip + outwards * (bit.radius + site_.voxel());
  const double step = 0.5 * site_.voxel();
  for (int n = 0; n < kMostMouthSteps; ++n) {
    const Vec3 place = rim + bit.axis * (n * step);
    if (!site_.is_blocked(place)) return place;
  }
  return rim + bit.axis * (kMostMouthSteps * step);
}

/// A bit that stopped turning leaves what it held in the hole, round the cutting part.
void DebrisField::drop(const DebrisStep& now) noexcept {
  double left = held_ + waiting_chips_ + waiting_mist_;
  held_ = waiting_chips_ = waiting_mist_ = 0.0;
  const Quat from_bit = rotation_from_z(now.bit.axis);
  const double step = 0.5 * site_.voxel(), volume = std::max(quantum_, left / (4.0 * kMostPerStep));
  while (left > 0.0) {
    const double angle = 2.0 * std::numbers::pi * random(), radius = now.bit.radius * std::sqrt(random());
    DebrisParticle one = born(now, false);
    one.velocity = Vec3(0.0);
    one.volume = std::min(volume, left);
    one.position = now.bit.tip + radius * (from_bit * Vec3(portable_cos(angle), portable_sin(angle), 0.0));
    for (int n = 0; n < kMostMouthSteps && site_.is_blocked(one.position); ++n) one.position += step * now.bit.axis;
    left = one.volume < left ? left - one.volume : 0.0;
    add(one);
  }
}

void DebrisField::add(const DebrisParticle& one) noexcept {
  if (particles_.size() == config_.most_particles && !merged_now_) {
    const std::size_t freed = merge_settled();
    merged_ += freed;
    merged_now_ = freed < config_.most_particles / kLeastFreed;
  }
  if (particles_.size() < config_.most_particles) {
    particles_.push_back(one);
    seats_.emplace_back();
    return;
  }
  particles_[static_cast<std::size_t>(random() * static_cast<double>(particles_.size()))].volume += one.volume;
  ++merged_;
}

std::size_t DebrisField::merge_settled() noexcept {
  const std::size_t before = particles_.size();
  // Blocks of twice the edge at each call: a heap of particles that each fill a cell merges too.
  block_ *= 2.0;
  const auto block_of = [this](const DebrisParticle& one) {
    return one.settled ? site_.cell_of(site_.box().lo + (one.position - site_.box().lo) / block_) : DebrisSite::kNowhere;
  };
  for (std::size_t n = 0; n < particles_.size();) {
    const std::size_t block = block_of(particles_[n]);
    if (block == DebrisSite::kNowhere || first_[block] == kNone) {
      if (block != DebrisSite::kNowhere) first_[block] = static_cast<std::uint32_t>(n);
      ++n;
      continue;
    }
    DebrisParticle& other = particles_[first_[block]];
    site_.take_off(other.position, config_.bulk * other.volume);
    other.volume += particles_[n].volume;
    site_.pile(other.position, config_.bulk * other.volume);
    first_[block] = kNone;
    remove(n);  // the last particle is at n now
  }
  for (const DebrisParticle& one : particles_)
    if (const std::size_t block = block_of(one); block != DebrisSite::kNowhere) first_[block] = kNone;
  quantum_ *= 2.0;
  return before - particles_.size();
}

void DebrisField::take_up(const DebrisBit& bit) noexcept {
  for (std::size_t n = 0; n < particles_.size();) {
    const Vec3 from_tip = particles_[n].position - bit.tip;
    const double along = glm::dot(from_tip, bit.axis);
    const bool within = particles_[n].settled && along > -site_.voxel() && along < bit.height &&
                        glm::dot(from_tip, from_tip) - along * along < bit.radius * bit.radius;
    if (!within) {
      ++n;
      continue;
    }
    held_ += particles_[n].volume;
    remove(n);
  }
}

DebrisField::Seat& DebrisField::seat_of(std::size_t n) noexcept {
  Seat& seat = seats_[n];
  if (seat.known) return seat;
  const Vec3& place = particles_[n].position;
  const Vec3 below = site_.below(place);
  // kNowhere is all bits, here as there; there are fewer cells than 2^32.
  seat = {.known = true,
          .on_bone = site_.is_solid(below),
          .cell = static_cast<std::uint32_t>(site_.cell_of(place)),
          .below = static_cast<std::uint32_t>(site_.cell_of(below))};
  return seat;
}

/// As is_carried() of all that has settled; where bone did not change, its share of that is known.
void DebrisField::loosen() noexcept {
  const std::optional<Bounds> changed = site_.take_changed();
  const auto is_inside = [](const Bounds& box, const Vec3& p) {
    return p.x >= box.lo.x && p.y >= box.lo.y && p.z >= box.lo.z && p.x <= box.hi.x && p.y <= box.hi.y && p.z <= box.hi.z;
  };
  for (std::size_t n = 0; n < particles_.size(); ++n) {
    if (!particles_[n].settled) continue;
    if (changed && seats_[n].known && is_inside(*changed, site_.below(particles_[n].position))) seats_[n].known = false;
    const Seat& seat = seat_of(n);
    if (!seat.on_bone && !site_.is_heaped({cell_at(seat.cell), cell_at(seat.below)})) lift(particles_[n]);
  }
}

/// A heap that was held by the bit, or that lost its foot, slides: each particle is tested once in kSlideTime.
void DebrisField::slide(double dt) noexcept {
  if (particles_.empty()) return;
  const auto count = static_cast<double>(particles_.size());
  to_test_ = std::min(count, to_test_ + count * dt / kSlideTime);
  for (; to_test_ >= 1.0; to_test_ -= 1.0) {
    DebrisParticle& one = particles_[++tested_ % particles_.size()];
    if (!one.settled) continue;
    if (const auto lower = site_.slide_from(one.position, config_.seed + drawn_++)) {
      lift(one);
      one.position = *lower;
    }
  }
}

void DebrisField::fly(double dt) noexcept {
  for (std::size_t n = 0; n < particles_.size();) {
    if (!particles_[n].settled) seats_[n].known = false;
    if (particles_[n].settled || fly_one(particles_[n], dt)) {
      ++n;
      continue;
    }
    totals_.lost += particles_[n].volume;
    remove(n);
  }
}

bool DebrisField::fly_one(DebrisParticle& one, double dt) noexcept {
  const int steps = static_cast<int>(std::clamp(std::ceil(dt / kFlightStep), 1.0, kMostFlightSteps));
  const ChipDrag drag = chip_drag(config_.air, one.diameter);
  const Vec3 gravity = config_.air.gravity * site_.down();
  for (int n = 0; n < steps && !one.settled; ++n) {
    const Vec3 way = advance_chip(drag, gravity, dt / steps, one.velocity);
    const double free = site_.free_share(one.position, one.position + way);
    one.position += free * way;
    if (!site_.contains(one.position)) return false;
    if (free < 1.0) land(one);
  }
  return true;
}

void DebrisField::land(DebrisParticle& one) noexcept {
  one.velocity = Vec3(0.0);
  for (int n = 0; n < kMostClimbs && site_.is_full(site_.cell_of(one.position)); ++n) one.position -= site_.cell() * site_.down();
  if (const auto lower = site_.slide_from(one.position, config_.seed + drawn_++)) {
    one.position = *lower;
    return;
  }
  one.settled = true;
  site_.pile(one.position, config_.bulk * one.volume);
}

void DebrisField::rinse(const DebrisRinse& saline, double dt) noexcept {
  const double reach2 = saline.reach * saline.reach;
  const auto is_wet = [&](const DebrisParticle& one) {
    const Vec3 way = one.position - saline.centre;
    return glm::dot(way, way) <= reach2;
  };
  double wet = 0.0;
  for (const DebrisParticle& one : particles_)
    if (is_wet(one)) wet += one.volume;
  const double gone = washed(wet, {config_.rinse_time, config_.rinse_load * saline.flow}, dt);
  if (!(gone > 0.0)) return;
  const double share = gone / wet;
  for (std::size_t n = 0; n < particles_.size();) {
    DebrisParticle& one = particles_[n];
    if (!is_wet(one)) {
      ++n;
      continue;
    }
    const double least = kRinsedWhole * config_.particle * (one.is_mist ? kMistQuantum : 1.0);
    const double left = one.volume * (1.0 - share);
    totals_.rinsed += left < least ? one.volume : one.volume - left;
    if (left < least) {
      remove(n);
      continue;
    }
    one.volume = left;
    ++n;
  }
}

void DebrisField::suck(const DebrisSuction& suction) noexcept {
  for (std::size_t n = 0; n < particles_.size();) {
    const Vec3 way = particles_[n].position - suction.nozzle;
    const double r2 = glm::dot(way, way);
    const double falls = terminal_speed(chip_drag(config_.air, particles_[n].diameter), config_.air.gravity);
    if (r2 > suction.reach * suction.reach || suction.flow < 4.0 * std::numbers::pi * r2 * falls) {
      ++n;
      continue;
    }
    totals_.sucked += particles_[n].volume;
    remove(n);
  }
}

void DebrisField::remove(std::size_t n) noexcept {
  if (particles_[n].settled) lift(particles_[n]);
  particles_[n] = particles_.back();
  particles_.pop_back();
  seats_[n] = seats_.back();
  seats_.pop_back();
}

/// Takes a settled particle off its heap cell.
void DebrisField::lift(DebrisParticle& one) noexcept {
  one.settled = false;
  site_.take_off(one.position, config_.bulk * one.volume);
}

/// Counts again what lies in the cells, without the rounding of what came and went.
void DebrisField::refill() noexcept {
  for (std::size_t n = 0; n < particles_.size(); ++n) {
    const DebrisParticle& one = particles_[n];
    site_.clear_pile(one.position, one.settled ? cell_at(seat_of(n).cell) : site_.cell_of(one.position), config_.bulk * one.volume);
  }
  for (std::size_t n = 0; n < particles_.size(); ++n) {
    const DebrisParticle& one = particles_[n];
    if (one.settled) site_.pile(one.position, cell_at(seat_of(n).cell), config_.bulk * one.volume);
  }
}

void DebrisField::bone_came_back() noexcept {
  totals_.undone += held();
  held_ = waiting_chips_ = waiting_mist_ = 0.0;
  holds_ = false;
  birth_count_ = 0;
  for (std::size_t n = 0; n < particles_.size();) {
    const DebrisParticle& one = particles_[n];
    if (site_.bone_at(one.birth.voxel) <= one.birth.left && !site_.is_solid(one.position)) {
      ++n;
      continue;
    }
    totals_.undone += one.volume;
    remove(n);
  }
  refill();
}

double DebrisField::flying() const noexcept {
  double sum = 0.0;
  for (const DebrisParticle& one : particles_)
    if (!one.settled) sum += one.volume;
  return sum;
}

double DebrisField::settled() const noexcept {
  double sum = 0.0;
  for (const DebrisParticle& one : particles_)
    if (one.settled) sum += one.volume;
  return sum;
}

double DebrisField::mist() const noexcept {
  double sum = 0.0;
  for (const DebrisParticle& one : particles_)
    if (!one.settled && one.is_mist) sum += one.volume;
  return sum;
}

double DebrisField::balance_error() const noexcept {
  if (!(totals_.removed > 0.0)) return 0.0;
  const double rest = held() + flying() + settled() + totals_.rinsed + totals_.sucked + totals_.lost + totals_.undone;
  return std::abs(totals_.removed - rest) / totals_.removed;
}

double DebrisField::radius_of(const DebrisParticle& one) const noexcept {
  return std::cbrt(0.75 / std::numbers::pi * config_.bulk * one.volume);
}

double DebrisField::hidden_share(const Vec3& centre, const Vec3& axis, double radius) const noexcept {
  std::array<std::uint8_t, static_cast<std::size_t>(kRaster) * kRaster> covered{};
  const Quat to_disc = glm::conjugate(rotation_from_z(axis));
  const double pitch = 2.0 * radius / kRaster;
  double largest = 0.0;
  for (const DebrisParticle& one : particles_) largest = std::max(largest, one.volume);
  // Beyond it no particle reaches the disc; with room for rounding.
  const double beyond = radius + (1.0 + 1e-9) * radius_of({.volume = largest});
  const auto node_of = [](int i, int j) { return static_cast<std::size_t>(j) * kRaster + static_cast<std::size_t>(i); };
  const auto node = [&](int n) { return (n + 0.5) * pitch - radius; };
  for (const DebrisParticle& one : particles_) {
    if (!one.settled) continue;
    const Vec3 at = to_disc * (one.position - centre);
    if (at.x * at.x + at.y * at.y > beyond * beyond) continue;
    const double reach = radius_of(one);
    if (at.x * at.x + at.y * at.y > (radius + reach) * (radius + reach)) continue;
    const auto first = [&](double x) { return std::max(0, static_cast<int>((x - reach + radius) / pitch)); };
    const auto last = [&](double x) { return std::min(kRaster - 1, static_cast<int>((x + reach + radius) / pitch)); };
    for (int j = first(at.y); j <= last(at.y); ++j)
      for (int i = first(at.x); i <= last(at.x); ++i) {
        const double x = node(i) - at.x, y = node(j) - at.y;
        if (x * x + y * y <= reach * reach) covered[node_of(i, j)] = 1;
      }
  }
  std::array<double, static_cast<std::size_t>(kRaster)> square{};
  for (int i = 0; i < kRaster; ++i) square[node_of(i, 0)] = node(i) * node(i);
  int inside = 0, hidden = 0;
  for (int j = 0; j < kRaster; ++j)
    for (int i = 0; i < kRaster; ++i) {
      const int is_inside = square[node_of(i, 0)] + square[node_of(j, 0)] > radius * radius ? 0 : 1;
      inside += is_inside;
      hidden += is_inside & covered[node_of(i, j)];
    }
  return static_cast<double>(hidden) / inside;
}

}  // namespace burrhole
