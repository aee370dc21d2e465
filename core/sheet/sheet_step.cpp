// A step of ElasticSheet: Newton's method on its merit, and the division of a step in which the sheet tears.

#include <algorithm>
#include <cmath>

#include "core/sheet/elastic_sheet.h"

namespace burrhole {
namespace {

constexpr int kMostNewton = 25, kMostHalvings = 30;
constexpr double kForceTolerance = 1e-6;  // [N] of the sum of all nodes
constexpr double kShare = 1e-4;           // [-] of the forces of tool and pressure, of that sum: what a larger load may leave
constexpr double kDescent = 1e-4;         // [-] of the slope, least decrease of a step
// A tear. Force goes with about the 3/2 power of strain, so 2 % of the limit are 3 % of the force.
constexpr double kOver = 0.02;                     // [-] of the strain limit by which an edge may exceed it before it breaks
constexpr double kAlike = 0.01;                    // [-] of the largest strain, within which edges break together
constexpr double kLeastAdvance = 0.005;            // [spacings] of the tool in a part, below which any strain is accepted
constexpr double kShortest = 0.1, kLongest = 0.7;  // [-] of a part that was refused, that the next try has
constexpr double kGrowth = 2.0;                    // [-] of a part that was accepted, that the next one may have

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += glm::dot(a[n], b[n]);
  return sum;
}

Vec3 point_at(const SheetLoad& load, std::size_t n, double share) noexcept {
  const Vec3& to = load.tool_points[n];
  if (load.tool_from.size() != load.tool_points.size() || share == 1.0) return to;
  return load.tool_from[n] + share * (to - load.tool_from[n]);
}

/// [m] the longest way of a point in the step.
double way_of(const SheetLoad& load) noexcept {
  double out = 0.0;
  if (load.tool_from.size() == load.tool_points.size())
    for (std::size_t n = 0; n < load.tool_points.size(); ++n)
      if (const double way = glm::length(load.tool_points[n] - load.tool_from[n]); std::isfinite(way)) out = std::max(out, way);
  return out;
}

}  // namespace

void ElasticSheet::find_pressed(const SheetLoad& load, double share) {
  pressed_.clear();
  for (std::size_t k = 0; k < load.tool_points.size(); ++k) {
    const Vec3 point = point_at(load, k, share);
    if (!is_finite(point)) continue;
    const auto place = lattice_.find(point.x, point.y);
    if (!place || point.z >= height_at(*place, rest_)) continue;
    const auto& n = place->nodes;
    if (held_[n[0]] == 0) continue;  // and so the others, unless an edge between them is broken
    const std::array edges{lattice_.edge(n[1], n[2]), lattice_.edge(n[2], n[0]), lattice_.edge(n[0], n[1])};
    if (std::ranges::any_of(edges, [this](std::uint32_t edge) { return is_broken(edge); })) continue;
    pressed_.push_back({*place, edges, point.z});
  }
}

double ElasticSheet::predict(double dt, double pressure) {
  const double per_dt = config_.resistance / dt, here = merit(x_, per_dt, pressure);
  if (moved_in_ == 0.0) return here;
  const double ratio = dt / moved_in_;
  for (std::size_t n = 0; n < x_.size(); ++n) trial_[n] = x_[n] + ratio * moved_[n];
  const double there = merit(trial_, per_dt, pressure);
  if (!(there < here)) return here;
  x_.swap(trial_);
  return there;
}

bool ElasticSheet::minimise(double per_dt, double pressure, double now) {
  for (int n = 0; n < kMostNewton; ++n) {
    const double load_size = slope(x_, per_dt, pressure, gradient_);
    ++iterations_;
    const double size = std::sqrt(dot(gradient_, gradient_));
    const double enough = std::max(kForceTolerance, kShare * load_size);
    if (!(size > enough)) return true;
    for (Vec3& g : gradient_) g = -g;
    curve(x_, per_dt);
    std::ranges::fill(direction_, Vec3(0.0));
    solve(gradient_, direction_, std::min(0.1, std::max(std::sqrt(size), 0.3 * enough / size)));
    const double downhill = dot(gradient_, direction_);
    double share = 1.0, next = now;
    int halved = 0;
    for (; halved < kMostHalvings; ++halved, share *= 0.5) {
      for (std::size_t k = 0; k < x_.size(); ++k) trial_[k] = x_[k] + share * direction_[k];
      next = merit(trial_, per_dt, pressure);
      if (next <= now - kDescent * share * downhill) break;
    }
    if (halved == kMostHalvings) return true;  // as near as the digits allow
    x_.swap(trial_);
    now = next;
  }
  return false;
}

bool ElasticSheet::advance(const Part& part, double dt, const SheetLoad& load) {
  const double per_dt = config_.resistance / (part.length * dt), most = (1.0 + kOver) * config_.strain_limit;
  const double pressure = std::isfinite(load.pressure) ? load.pressure : 0.0;
  const double share = part.share + part.length;
  find_pressed(load, share < 1.0 ? share : 1.0);
  before_ = x_;
  bool converged = minimise(per_dt, pressure, predict(part.length * dt, pressure));
  ++state_.parts;
  double strain = largest_strain();
  if (part.edges == Edges::below_limit && (strain > most || !converged)) {
    state_.strain = strain;
    x_ = before_;
    return false;
  }
  for (;;) {
    if (strain <= most && converged) {  // a state that is not at rest, or will break, is no figure of the run
      const double force = tool_force();
      state_.peak = std::max(state_.peak, force);
      if (force > 0.0) state_.deepest = std::max(state_.deepest, lowest());
      state_.stretched = std::max(state_.stretched, strain);
    }
    // One at a time, as the next one may be spared; near the bound on solutions all at once.
    if (state_.parts >= kMostParts + kMostLastParts || break_edges(state_.parts < kMostParts ? (1.0 - kAlike) * strain : 0.0) == 0) break;
    find_pressed(load, share < 1.0 ? share : 1.0);
    converged = minimise(per_dt, pressure, merit(x_, per_dt, pressure));
    ++state_.parts;
    strain = largest_strain();
  }
  for (std::size_t n = 0; n < x_.size(); ++n) moved_[n] = x_[n] - before_[n];
  moved_in_ = part.length * dt;
  come_off();
  return true;
}

const SheetState& ElasticSheet::step(double dt, const SheetLoad& load) {
  const double way = way_of(load), target = (1.0 + 0.5 * kOver) * config_.strain_limit;
  const double least = way > 0.0 ? kLeastAdvance * lattice_.spacing() / way : 1.0;
  state_.parts = 0;
  state_.peak = state_.deepest = state_.stretched = 0.0;
  for (double share = 0.0, length = 1.0; share < 1.0;) {
    length = std::min(length, 1.0 - share);
    const bool last = state_.parts + 1 >= kMostParts;
    if (last) length = 1.0 - share;
    const double strain = largest_strain();
    if (advance({share, length, last || length <= least ? Edges::any : Edges::below_limit}, dt, load)) {
      share = length == 1.0 - share ? 1.0 : share + length;
      length *= kGrowth;
      continue;
    }
    const double growth = state_.strain - strain, room = target - strain;
    length *= std::clamp(growth > 0.0 ? room / growth : kLongest, kShortest, kLongest);
    length = std::max(length, std::min(least, 1.0));
  }
  measure();
  return state_;
}

double ElasticSheet::strain_of(std::size_t edge) const noexcept {
  const SheetEdge& ends = lattice_.edges()[edge];
  return glm::length(x_[ends.a] - x_[ends.b]) / length_[edge] - 1.0;
}

double ElasticSheet::largest_strain() const noexcept {
  double out = 0.0;
  for (std::size_t e = 0; e < length_.size(); ++e)
    if (broken_[e] == 0) out = std::max(out, strain_of(e));
  return out;
}

double ElasticSheet::tool_force() const noexcept {
  double out = 0.0;
  for (const Pressed& point : pressed_) out += config_.tool_stiffness * std::max(0.0, height_at(point.place, x_) - point.z);
  return out;
}

double ElasticSheet::lowest() const noexcept {
  double out = 0.0;
  for (std::size_t n = 0; n < x_.size(); ++n) out = std::max(out, rest_[n].z - x_[n].z);
  return out;
}

std::size_t ElasticSheet::break_edges(double above) noexcept {
  std::size_t out = 0;
  for (std::size_t e = 0; e < length_.size(); ++e) {
    if (broken_[e] != 0) continue;
    if (const double strain = strain_of(e); strain <= config_.strain_limit || strain < above) continue;
    broken_[e] = 1;
    ++out;
  }
  state_.torn += out;
  if (out > 0) find_held();
  return out;
}

void ElasticSheet::find_held() noexcept {
  std::ranges::fill(held_, std::uint8_t{0});
  queue_.assign(rim_.begin(), rim_.end());
  for (const std::uint32_t n : rim_) held_[n] = 1;
  while (!queue_.empty()) {
    const std::uint32_t n = queue_.back();
    queue_.pop_back();
    for (const std::uint32_t other : lattice_.neighbours(n)) {
      if (other == SheetLattice::kNoNode || held_[other] != 0 || is_broken(lattice_.edge(n, other))) continue;
      held_[other] = 1;
      queue_.push_back(other);
    }
  }
}

void ElasticSheet::come_off() noexcept {
  for (std::size_t n = 0; n < x_.size(); ++n) {
    if (sticks_[n] == 0 || glm::length(x_[n] - rest_[n]) <= config_.adhesion_way) continue;
    sticks_[n] = 0;
    state_.separated += lattice_.area();
  }
}

}  // namespace burrhole
