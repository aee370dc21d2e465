#include "core/contact/friction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace burrhole {
namespace {

// Solution. With the move x of the tool, free move f, springs K and pressed points i of limits L_i, x is the minimum of
//     1/2 (x - f) K (x - f) + sum_i L_i |u_i(x)|,   u_i the displacement over bone in the plane of the point.
// The forces at the minimum are Coulomb's. L |u| has a corner at u = 0, where a point sticks. Moreau's envelope with a stiffness S smooths
// it: T = q limited to length L, q = m - S u, of energy |q|^2 / 2S where |q| <= L and (L |q| - L^2 / 2) / S beyond. The multiplier m is the
// load of the last round (augmented Lagrangian), so sticking points converge to u = 0 for any S: each round leaves about K / S of u, or
// turn stiffness / (S arm^2). S grows from round to round, because with a large S Newton's method finds the narrow region where a point
// sticks by bisection only. In a round the energy is convex with a continuous slope, in six unknowns.
// That is the way for any problem, and a slow one. As a rule each point either slides far from its corner, where L |u| is smooth, or rests
// well inside its limit, where u = 0 is a linear condition. part() takes points as they were, lets resting ones keep u = 0 by a multiplier
// and a stiffness S without a limit, and takes two or three Newton steps on the energy of the sliding ones. A point that goes through its
// corner in a step then rests; one that rests with more than its limit starts with that limit and slides on. What part() finds fulfils
// Coulomb's conditions at each point, so it is the minimum; otherwise the envelope finds it.
//   When to stop: along a step h that displaces points by at most d, the third derivative of L |u| is at most 3 d / |u| of the second, so
//   the next step is at most 3/2 d / |u| of h, both measured in the energy. That bounds what is left without another step.
constexpr double kHeld = 1e7;         // [-] S of resting points over the stiffness of the springs: loads that change by 0.1 N leave 1e-12 m
constexpr double kOnCorner = 1e-15;   // [m] a point that moves less is at its corner
constexpr double kNearCorner = 1e-9;  // [m] sliding points that are nearer to their corner are left to the envelope
constexpr double kLeastStiff = 1e3, kStiff = 1e5, kStiffer = 100.0;  // [-] S over the stiffness of the springs: first, largest, growth
constexpr double kFarEnough = 0.5;                                   // [-] a line search ends below this fraction of the initial slope
constexpr double kSettled = 1e-12;                                   // [m] of sticking points, and of a Newton step: a tenth of kSlip
constexpr double kSlip = 1e-11;             // [m] smaller slips are the solver's residual; 1 um/s over 1 ms is 100 times that
constexpr int kMaxBreaks = 4;               // rounds of changing sticking points to sliding; after the last all of them slide
constexpr double kLargestStiffness = 1e12;  // [N m/rad] replaces infinity

Vec3 along_plane(const Vec3& v, const Vec3& normal) noexcept { return v - normal * glm::dot(v, normal); }

Vec3 shortened(const Vec3& v, double most) noexcept {
  const double length = glm::length(v);
  return length > most ? v * (most / length) : v;
}

/// The stiffness of springs and planes.
Matrix6 supports(const TangentialProblem& problem) noexcept {
  Matrix6 out = problem.planes != nullptr ? *problem.planes : Matrix6{};
  for (std::size_t n = 0; n < 6; ++n) out[n][n] += n < 3 ? problem.stiffness : problem.turn_stiffness;
  return out;
}

/// Adds the stiffness `weight` [N/m] of a point along a direction.
void add_row(const Vec3& arm, const Vec3& direction, double weight, Matrix6& matrix) noexcept {
  const Vec3 lever = glm::cross(arm, direction);
  const Vector6 j{direction.x, direction.y, direction.z, lever.x, lever.y, lever.z};
  for (std::size_t r = 0; r < 6; ++r) {
    const double weighted = weight * j[r];
    for (std::size_t c = 0; c <= r; ++c) matrix[r][c] += weighted * j[c];
  }
}

/// @returns a unit vector across a unit vector.
Vec3 across(const Vec3& normal) noexcept {
  return glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.7 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0)));
}

/// @returns the Newton step that the forces `left` make.
SmallMove way_of(const Matrix6& matrix, const Wrench& left) noexcept {
  const Vector6 d = solve_spd(matrix, {left.force.x, left.force.y, left.force.z, left.torque.x, left.torque.y, left.torque.z});
  return {{d[0], d[1], d[2]}, {d[3], d[4], d[5]}};
}

double work_of(const Wrench& forces, const SmallMove& way) noexcept {
  return glm::dot(forces.force, way.translation) + glm::dot(forces.torque, way.turn);
}

}  // namespace

Result<Friction> Friction::create(const FrictionConfig& config) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(config.kinetic_coefficient >= 0.0 && config.kinetic_coefficient <= 2.0))
    return refuse("kinetic coefficient of friction must be in [0, 2]");
  if (!(config.static_coefficient >= config.kinetic_coefficient && config.static_coefficient <= 2.0))
    return refuse("static coefficient of friction must be at least the kinetic one and at most 2");
  return Friction(config);
}

void Friction::clear() noexcept {
  before_count_ = now_count_ = count_ = 0;
  owed_ = let_ = {};
  sliding_ = false;
}

void Friction::set_points(const TangentialProblem& problem) noexcept {
  count_ = 0;
  lever_ = 0.0;
  held_ = {};
  const auto kept_of = [&](const auto& list, std::size_t count, std::uint32_t point) -> const Kept* {
    if (count_ < count && list[count_].point == point) return &list[count_];  // the usual case: the list of the call before
    const auto end = list.begin() + static_cast<std::ptrdiff_t>(count);
    const auto found = std::find_if(list.begin(), end, [&](const Kept& kept) { return kept.point == point; });
    return found != end ? &*found : nullptr;
  };
  for (const PressedPoint& pressed : problem.points) {
    if (count_ == kMaxPressedPoints || !(pressed.load > 0.0)) continue;
    const Vec3 rim = along_plane(glm::cross(problem.spin, pressed.arm), pressed.normal) * problem.dt;
    if (pressed.held) {
      // A force in the rim's direction; lateral stiffness while cutting, not the law, resists displacement here.
      const double length = glm::length(rim);
      if (length == 0.0) continue;
      const Vec3 load = rim * (-config_.kinetic_coefficient * pressed.load / length);
      held_.force += load;
      held_.torque += glm::cross(pressed.arm, load);
      continue;
    }
    const Kept* const before = kept_of(before_, before_count_, pressed.point);
    const Kept* const guess = kept_of(now_, now_count_, pressed.point);
    const Kept* const first = guess != nullptr ? guess : before;
    Point& point = points_[count_++];
    point.point = pressed.point;
    point.arm = pressed.arm;
    lever_ = std::max(lever_, glm::length(pressed.arm));
    point.normal = pressed.normal;
    point.start = along_plane(owed_.at(pressed.arm), pressed.normal) + rim;
    point.normal_load = pressed.load;
    point.slides = glm::length(rim) > kSlip || (before != nullptr && before->slides);
    const bool rested = first != nullptr ? !first->slides : !(glm::length(rim) > kSlip);
    point.state = rested ? State::rests : State::slides;
    point.released = false;
    point.limit = pressed.load * (point.slides ? config_.kinetic_coefficient : config_.static_coefficient);
    point.multiplier = first != nullptr ? shortened(along_plane(first->load, pressed.normal), point.limit) : Vec3(0.0);
  }
}

Vec3 Friction::displacement(const Point& point, const SmallMove& move) const noexcept {
  return point.start + along_plane(move.at(point.arm), point.normal);
}

double Friction::length_of(const SmallMove& move) const noexcept { return glm::length(move.translation) + lever_ * glm::length(move.turn); }

Wrench Friction::pull(const TangentialProblem& problem) const noexcept {
  const SmallMove off{problem.free.translation - move_.translation, problem.free.turn - move_.turn};
  Wrench out{problem.stiffness * off.translation + held_.force, problem.turn_stiffness * off.turn + held_.torque};
  if (problem.planes == nullptr) return out;
  const Vector6 x{off.translation.x, off.translation.y, off.translation.z, off.turn.x, off.turn.y, off.turn.z};
  Vector6 push{};
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t c = 0; c < 6; ++c) push[r] += (*problem.planes)[std::max(r, c)][std::min(r, c)] * x[c];
  out.force += Vec3(push[0], push[1], push[2]);
  out.torque += Vec3(push[3], push[4], push[5]);
  return out;
}

Wrench Friction::set_loads(const TangentialProblem& problem, double stiff) noexcept {
  Wrench out = pull(problem);
  for (Point& point : std::span(points_.data(), count_)) {
    point.wanted = point.multiplier - stiff * displacement(point, move_);
    point.load = shortened(point.wanted, point.limit);
    out.force += point.load;
    out.torque += glm::cross(point.arm, point.load);
  }
  return out;
}

SmallMove Friction::newton_direction(const TangentialProblem& problem, const Wrench& left, double stiff) const noexcept {
  Matrix6 matrix = supports(problem);
  for (const Point& point : std::span(points_.data(), count_)) {
    const double length = glm::length(point.wanted);
    const bool sticks = length <= point.limit;
    // Two directions in the plane: along the load, where a sliding point has no stiffness, and across it.
    const Vec3 along = length > 0.0 ? point.wanted / length : across(point.normal);
    if (sticks) add_row(point.arm, along, stiff, matrix);
    add_row(point.arm, glm::cross(point.normal, along), sticks ? stiff : stiff * (point.limit / length), matrix);
  }
  return way_of(matrix, left);
}

double Friction::newton_step(const TangentialProblem& problem, double stiff, Wrench& left) noexcept {
  const SmallMove way = newton_direction(problem, left, stiff), start = move_;
  // Negative slope of the energy along the direction; it starts above 0 and decreases monotonically.
  const auto drive = [&](double part) {
    move_ = {start.translation + part * way.translation, start.turn + part * way.turn};
    left = set_loads(problem, stiff);
    return work_of(left, way);
  };
  const double first = work_of(left, way);
  double low = 0.0, at_low = first, high = 1.0, part = 1.0, now = drive(1.0), at_high = now;
  for (int n = 0; n < kMaxHalvings && std::abs(now) > kFarEnough * first && high > low; ++n) {
    // Alternates bisection and secant steps.
    part = n % 2 == 0 && at_low > at_high ? low + (high - low) * at_low / (at_low - at_high) : 0.5 * (low + high);
    now = drive(part);
    (now > 0.0 ? low : high) = part;
    (now > 0.0 ? at_low : at_high) = now;
  }
  return part * length_of(way);
}

Friction::Slope Friction::slope(const TangentialProblem& problem) noexcept {
  const double stiff = kHeld * problem.stiffness;
  Slope out{.matrix = supports(problem), .left = pull(problem), .nearest = std::numeric_limits<double>::infinity()};
  for (Point& point : std::span(points_.data(), count_)) {
    point.moved = displacement(point, move_);
    const double length = glm::length(point.moved);
    if (point.state == State::slides && !(length > kOnCorner)) point.state = State::rests;  // it has no direction
    if (point.state == State::rests) {
      point.load = point.multiplier - stiff * point.moved;
      const Vec3 one = across(point.normal);
      add_row(point.arm, one, stiff, out.matrix);
      add_row(point.arm, glm::cross(point.normal, one), stiff, out.matrix);
    } else if (point.state == State::slides) {
      const Vec3 along = point.moved / length;
      point.load = -point.limit * along;
      add_row(point.arm, glm::cross(point.normal, along), point.limit / length, out.matrix);  // along the way there is no curvature
      out.nearest = std::min(out.nearest, length);
    } else {
      point.load = point.multiplier;
    }
    out.left.force += point.load;
    out.left.torque += glm::cross(point.arm, point.load);
  }
  ++passes_;
  return out;
}

bool Friction::stop_turned() noexcept {
  bool any = false;
  for (Point& point : std::span(points_.data(), count_)) {
    if (point.state != State::slides || point.released || glm::dot(point.from, point.moved) > 0.0) continue;
    point.state = State::rests;
    point.multiplier = shortened(point.multiplier, point.limit);
    any = true;
  }
  return any;
}

double Friction::descend(const TangentialProblem& problem, Slope& here) noexcept {
  constexpr double kNotArrived = std::numeric_limits<double>::infinity();
  const SmallMove way = way_of(here.matrix, here.left), start = move_;
  const double first = work_of(here.left, way);
  double nearest = here.nearest, part = 1.0, low = 0.0, high = 1.0, at_low = first, at_high = 0.0;
  for (Point& point : std::span(points_.data(), count_)) point.from = point.moved;
  for (;;) {
    move_ = {start.translation + part * way.translation, start.turn + part * way.turn};
    here = slope(problem);
    nearest = std::min(nearest, here.nearest);
    if (part == 1.0 && stop_turned()) {
      move_ = start;
      here = slope(problem);
      return kNotArrived;
    }
    const double now = work_of(here.left, way);  // falls along the way
    if (!(std::abs(now) > kFarEnough * first) || (part == 1.0 && now > 0.0)) break;
    if (passes_ >= kMaxPasses) return kNotArrived;
    (now > 0.0 ? low : high) = part;
    (now > 0.0 ? at_low : at_high) = now;
    part = low + (high - low) * std::clamp(at_low / (at_low - at_high), 0.1, 0.9);
  }
  bool slid = false;
  for (Point& point : std::span(points_.data(), count_)) {
    if (point.state != State::starts || glm::length(point.moved) <= kSettled) continue;
    point.state = State::slides;
    slid = true;
  }
  if (slid) here = slope(problem);
  if (slid || part < 1.0 || !(here.nearest > kNearCorner)) return kNotArrived;
  // [N/m] at least, of the springs against a displacement of any point.
  const double softest = 0.5 * std::min(problem.stiffness, problem.turn_stiffness / (lever_ * lever_));
  return 1.5 * length_of(way) / nearest * std::sqrt(first / softest);
}

bool Friction::correct_resting(double stiff) noexcept {
  bool changed = false;
  for (Point& point : std::span(points_.data(), count_)) {
    if (point.state != State::rests) continue;
    const bool over = glm::length(point.load) > point.limit;
    if (over) {
      point.state = State::starts;
      point.released = true;
      point.load = shortened(point.load, point.limit);
    }
    changed = changed || over || glm::length(point.load - point.multiplier) > kSettled * stiff;
    point.multiplier = point.load;
  }
  return changed;
}

bool Friction::part(const TangentialProblem& problem) noexcept {
  passes_ = 0;
  Slope here = slope(problem);
  while (passes_ < kMaxPasses) {
    if (!(descend(problem, here) <= kSettled)) continue;
    if (!correct_resting(kHeld * problem.stiffness)) return true;
    here = slope(problem);
  }
  return false;
}

void Friction::solve(const TangentialProblem& problem) noexcept {
  if (!part(problem)) settle(problem);
}

void Friction::settle(const TangentialProblem& problem) noexcept {
  double stiff = kLeastStiff * problem.stiffness;
  const double most = kStiff * problem.stiffness;
  for (int round = 0, step = 0; round < kMaxRounds && step < kMaxSteps; ++round, stiff = std::min(kStiffer * stiff, most)) {
    Wrench left = set_loads(problem, stiff);
    for (; step < kMaxSteps; ++step)
      if (newton_step(problem, stiff, left) <= kSettled) break;
    double largest = 0.0;
    for (Point& point : std::span(points_.data(), count_)) {
      // The displacement for a sticking point; the remaining rotation of the load for a sliding one.
      largest = std::max(largest, glm::length(point.load - point.multiplier) / stiff);
      point.multiplier = point.load;
    }
    if (largest <= kSettled) return;
  }
}

bool Friction::let_slide() noexcept {
  bool any = false;
  for (Point& point : std::span(points_.data(), count_)) {
    if (point.slides || glm::length(displacement(point, move_)) <= kSlip) continue;
    point.slides = any = true;
    point.limit = point.normal_load * config_.kinetic_coefficient;
    point.multiplier = shortened(point.load, point.limit);
    point.state = State::slides;
  }
  return any;
}

void Friction::keep() noexcept {
  now_count_ = 0;
  sliding_ = false;
  for (const Point& point : std::span(points_.data(), count_)) {
    const bool slides = point.slides && glm::length(displacement(point, move_)) > kSlip;
    now_[now_count_++] = {point.point, slides, point.load};
    sliding_ = sliding_ || slides;
  }
}

TangentialLoads Friction::loads(const TangentialProblem& asked) noexcept {
  TangentialProblem problem = asked;
  problem.turn_stiffness = std::min(asked.turn_stiffness, kLargestStiffness);
  set_points(problem);
  if (count_ > 0) {
    move_ = problem.free;
    Wrench guess = held_;
    for (const Point& point : std::span(points_.data(), count_)) {
      guess.force += point.multiplier;
      guess.torque += glm::cross(point.arm, point.multiplier);
    }
    const SmallMove added = way_of(supports(problem), guess);
    move_.translation += added.translation;
    move_.turn += added.turn;
    solve(problem);
    if (config_.static_coefficient > config_.kinetic_coefficient)
      for (int n = 0; n < kMaxBreaks && let_slide(); ++n) solve(problem);
  }
  keep();
  Wrench sum = held_;
  for (const Point& point : std::span(points_.data(), count_)) {
    sum.force += point.load;
    sum.torque += glm::cross(point.arm, point.load);
  }
  const SmallMove added = way_of(supports(problem), sum);
  let_ = {problem.free.translation + added.translation, problem.free.turn + added.turn};
  return {sum, let_};
}

void Friction::end_step(const SmallMove& moved) noexcept {
  before_ = now_;
  before_count_ = now_count_;
  owed_ = now_count_ > 0 ? SmallMove{moved.translation - let_.translation, moved.turn - let_.turn} : SmallMove{};
}

}  // namespace burrhole
