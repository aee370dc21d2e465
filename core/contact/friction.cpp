#include "core/contact/friction.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/base/spd.h"

namespace burrhole {
namespace {

// Solution. With the move x of the tool, free move f, springs K and pressed points i of limits L_i, x is the minimum of
//     1/2 (x - f) K (x - f) + sum_i L_i |u_i(x)|,   u_i the displacement over bone in the plane of the point.
// The forces at the minimum are Coulomb's. L |u| has a corner at u = 0, where a point sticks. Moreau's envelope with a stiffness S smooths
// it: T = q limited to length L, q = m - S u, of energy |q|^2 / 2S where |q| <= L and (L |q| - L^2 / 2) / S beyond. The multiplier m is the
// load of the last round (augmented Lagrangian), so sticking points converge to u = 0 for any S: each round leaves about K / S of u, or
// turn stiffness / (S arm^2). S grows from round to round, because with a large S Newton's method finds the narrow region where a point
// sticks by bisection only. In a round the energy is convex with a continuous slope, in six unknowns.
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
  held_ = {};
  const auto kept_of = [](const auto& list, std::size_t count, std::uint32_t point) -> const Kept* {
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
    point.normal = pressed.normal;
    point.start = along_plane(owed_.at(pressed.arm), pressed.normal) + rim;
    point.normal_load = pressed.load;
    point.slides = glm::length(rim) > kSlip || (before != nullptr && before->slides);
    point.limit = pressed.load * (point.slides ? config_.kinetic_coefficient : config_.static_coefficient);
    point.multiplier = first != nullptr ? shortened(along_plane(first->load, pressed.normal), point.limit) : Vec3(0.0);
  }
}

Vec3 Friction::displacement(const Point& point, const SmallMove& move) const noexcept {
  return point.start + along_plane(move.at(point.arm), point.normal);
}

void Friction::set_loads(const SmallMove& move, double stiff) noexcept {
  for (Point& point : std::span(points_.data(), count_))
    point.load = shortened(point.multiplier - stiff * displacement(point, move), point.limit);
}

Wrench Friction::residual(const TangentialProblem& problem, const SmallMove& move) const noexcept {
  Wrench out{problem.stiffness * (problem.free.translation - move.translation) + held_.force,
             problem.turn_stiffness * (problem.free.turn - move.turn) + held_.torque};
  for (const Point& point : std::span(points_.data(), count_)) {
    out.force += point.load;
    out.torque += glm::cross(point.arm, point.load);
  }
  return out;
}

SmallMove Friction::newton_direction(const TangentialProblem& problem, double stiff) const noexcept {
  Matrix6 matrix{};
  for (std::size_t n = 0; n < 6; ++n) matrix[n][n] = n < 3 ? problem.stiffness : problem.turn_stiffness;
  for (const Point& point : std::span(points_.data(), count_)) {
    const Vec3 q = point.multiplier - stiff * displacement(point, move_);
    const double length = glm::length(q);
    const bool sticks = length <= point.limit;
    // Two directions in the plane: along q, where a sliding point has no stiffness, and across it.
    const Vec3 side = std::abs(point.normal.x) < 0.7 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    const Vec3 along = length > 0.0 ? q / length : glm::normalize(glm::cross(point.normal, side));
    const Vec3 across = glm::cross(point.normal, along);
    const std::array<std::pair<Vec3, double>, 2> rows{
        {{along, sticks ? stiff : 0.0}, {across, sticks ? stiff : stiff * (point.limit / length)}}};
    for (const auto& [direction, weight] : rows) {
      if (weight == 0.0) continue;
      const Vec3 lever = glm::cross(point.arm, direction);
      const Vector6 j{direction.x, direction.y, direction.z, lever.x, lever.y, lever.z};
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t c = 0; c <= r; ++c) matrix[r][c] += weight * j[r] * j[c];
    }
  }
  const Wrench left = residual(problem, move_);
  const Vector6 d = solve_spd(matrix, {left.force.x, left.force.y, left.force.z, left.torque.x, left.torque.y, left.torque.z});
  return {{d[0], d[1], d[2]}, {d[3], d[4], d[5]}};
}

double Friction::newton_step(const TangentialProblem& problem, double stiff) noexcept {
  const SmallMove way = newton_direction(problem, stiff), start = move_;
  // Negative slope of the energy along the direction; it starts above 0 and decreases monotonically.
  const auto drive = [&](double part) {
    move_ = {start.translation + part * way.translation, start.turn + part * way.turn};
    set_loads(move_, stiff);
    const Wrench left = residual(problem, move_);
    return glm::dot(left.force, way.translation) + glm::dot(left.torque, way.turn);
  };
  const Wrench left = residual(problem, start);
  const double first = glm::dot(left.force, way.translation) + glm::dot(left.torque, way.turn);
  double low = 0.0, at_low = first, high = 1.0, part = 1.0, now = drive(1.0), at_high = now;
  for (int n = 0; n < kMaxHalvings && std::abs(now) > kFarEnough * first && high > low; ++n) {
    // Alternates bisection and secant steps.
    part = n % 2 == 0 && at_low > at_high ? low + (high - low) * at_low / (at_low - at_high) : 0.5 * (low + high);
    now = drive(part);
    (now > 0.0 ? low : high) = part;
    (now > 0.0 ? at_low : at_high) = now;
  }
  double lever = 0.0;
  for (const Point& point : std::span(points_.data(), count_)) lever = std::max(lever, glm::length(point.arm));
  return part * (glm::length(way.translation) + lever * glm::length(way.turn));
}

void Friction::settle(const TangentialProblem& problem) noexcept {
  double stiff = kLeastStiff * problem.stiffness;
  const double most = kStiff * problem.stiffness;
  for (int round = 0; round < kMaxRounds; ++round, stiff = std::min(kStiffer * stiff, most)) {
    set_loads(move_, stiff);
    for (int step = 0; step < kMaxSteps; ++step)
      if (newton_step(problem, stiff) <= kSettled) break;
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
    point.multiplier = shortened(point.multiplier, point.limit);
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
    move_.translation += guess.force / problem.stiffness;
    move_.turn += guess.torque / problem.turn_stiffness;
    settle(problem);
    if (config_.static_coefficient > config_.kinetic_coefficient)
      for (int n = 0; n < kMaxBreaks && let_slide(); ++n) settle(problem);
  }
  keep();
  Wrench sum = held_;
  for (const Point& point : std::span(points_.data(), count_)) {
    sum.force += point.load;
    sum.torque += glm::cross(point.arm, point.load);
  }
  let_ = {problem.free.translation + sum.force / problem.stiffness, problem.free.turn + sum.torque / problem.turn_stiffness};
  return {sum, let_};
}

void Friction::end_step(const SmallMove& moved) noexcept {
  before_ = now_;
  before_count_ = now_count_;
  owed_ = now_count_ > 0 ? SmallMove{moved.translation - let_.translation, moved.turn - let_.turn} : SmallMove{};
}

}  // namespace burrhole
