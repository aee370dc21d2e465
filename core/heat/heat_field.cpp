#include "core/heat/heat_field.h"

#include <algorithm>
#include <cmath>

#include "core/heat/thermal_dose.h"

namespace burrhole {
namespace {

constexpr std::array<Vec3i, 3> kAxes{Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1)};

/// @returns the conductance between two cells over that of full bone.
float joint(float a, float b) noexcept {
  return a >= HeatField::kLeastShare && b >= HeatField::kLeastShare ? 2.0f * a * b / (a + b) : 0.0f;
}

}  // namespace

HeatField::HeatField(const HeatConfig& config, const Vec3& edges, const VoxelBox& domain)
    : config_(config),
      edges_(edges),
      domain_(domain),
      unit_(config.density * config.capacity * edges.x * edges.y * edges.z),
      longest_(config.fourier * std::pow(std::min({edges.x, edges.y, edges.z}), 2.0) / config.diffusivity()),
      rise_(domain.count()),
      share_(domain.count()),
      peak_(domain.count()),
      dose_(domain.count()) {}

Result<HeatField> HeatField::create(const HeatConfig& config, const Vec3& edges, const VoxelBox& domain) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  for (const double value :
       {config.conductivity, config.density, config.capacity, config.fourier, config.least_rise, edges.x, edges.y, edges.z})
    if (!(value > 0.0 && std::isfinite(value))) return refuse("the heat field's numbers must be above 0");
  if (!std::isfinite(config.body)) return refuse("the body's temperature must be a number");
  if (domain.empty()) return refuse("the heat field has no cell");
  return HeatField(config, edges, domain);
}

void HeatField::set_bone(const VoxelBox& box, std::span<const float> share) {
  for_each_voxel(box.intersect(domain_), [&](const Vec3i& cell) {
    const std::size_t here = domain_.offset_of(cell);
    const float before = share_[here], after = std::clamp(share[box.offset_of(cell)], 0.0f, 1.0f);
    if (before == after) return;
    share_[here] = after;
    const double heat = before >= kLeastShare ? unit_ * static_cast<double>(before) * static_cast<double>(rise_[here]) : 0.0;
    if (after < before) losses_.push_back({cell, before - after});
    if (after < kLeastShare) {
      balance_.chips += heat;
      rise_[here] = peak_[here] = dose_[here] = 0.0f;
    } else if (after < before) {
      balance_.chips += heat * static_cast<double>((before - after) / before);
    } else {
      rise_[here] = static_cast<float>(heat / (unit_ * static_cast<double>(after)));
    }
  });
}

void HeatField::add(std::size_t at, const Vec3i& cell, double joule) {
  rise_[at] += static_cast<float>(joule / (unit_ * static_cast<double>(share_[at])));
  warm_.include(cell);
}

void HeatField::release_at(const Vec3i& cell, double joule) {
  balance_.input += joule;
  if (share(cell) >= kLeastShare)
    add(domain_.offset_of(cell), cell, joule);
  else
    balance_.unplaced += joule;
}

void HeatField::release(double joule) {
  balance_.input += joule;
  double lost = 0.0;
  for (const Loss& loss : losses_) lost += static_cast<double>(loss.share);
  if (!(lost > 0.0)) {
    balance_.unplaced += joule;
    return;
  }
  for (const Loss& loss : losses_) {
    const double part = joule * static_cast<double>(loss.share) / lost;
    if (share(loss.cell) >= kLeastShare) {
      add(domain_.offset_of(loss.cell), loss.cell, part);
      continue;
    }
    const VoxelBox around = VoxelBox{loss.cell, loss.cell + 1}.grown(1).intersect(domain_);
    double bone = 0.0;
    for_each_voxel(around, [&](const Vec3i& cell) { bone += share(cell) >= kLeastShare ? static_cast<double>(share(cell)) : 0.0; });
    if (!(bone > 0.0)) {
      balance_.unplaced += part;
      continue;
    }
    for_each_voxel(around, [&](const Vec3i& cell) {
      if (share(cell) >= kLeastShare) add(domain_.offset_of(cell), cell, part * static_cast<double>(share(cell)) / bone);
    });
  }
  losses_.clear();
}

double HeatField::free_area(const Vec3i& cell) const noexcept {
  const float here = share(cell);
  double square = 0.0;
  const double volume = edges_.x * edges_.y * edges_.z;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3i step = kAxes[static_cast<std::size_t>(axis)];
    const float least = std::min(
        {here, domain_.contains(cell - step) ? share(cell - step) : here, domain_.contains(cell + step) ? share(cell + step) : here});
    const double area = static_cast<double>(here - least) * volume / edges_[axis];
    square += area * area;
  }
  return std::sqrt(square);
}

void HeatField::cool(const Cooling& cooling, double dt) {
  const Vec3 reach = Vec3(cooling.radius) / edges_;
  const VoxelBox box = VoxelBox{floor_int(cooling.centre - reach), floor_int(cooling.centre + reach) + 2}.intersect(domain_);
  // Twice: the heat that the film would take, then, scaled to what the arriving coolant can take, the heat that it takes.
  const double deep = std::max({edges_.x, edges_.y, edges_.z});
  double wanted = 0.0, warmest = cooling.rise, scale = 1.0;
  for (const bool takes : {false, true}) {
    for_each_voxel(box, [&](const Vec3i& cell) {
      const Vec3 from = (Vec3(cell) - cooling.centre) * edges_;
      const float here = share(cell);
      if (here < kLeastShare || glm::dot(from, from) > cooling.radius * cooling.radius || glm::dot(from, cooling.up) < -deep) return;
      const double area = free_area(cell);
      if (!(area > 0.0)) return;
      const std::size_t at = domain_.offset_of(cell);
      const double rise = static_cast<double>(rise_[at]), capacity = unit_ * static_cast<double>(here), flow = cooling.film * area * dt;
      const double taken = (rise - cooling.rise) * capacity * flow / (capacity + flow);
      if (takes) {
        rise_[at] = static_cast<float>(rise - scale * taken / capacity);
        balance_.cooled += scale * taken;
        warm_.include(cell);
      } else {
        wanted += taken;
        warmest = std::max(warmest, rise);
      }
    });
    const double most = cooling.arriving * dt * (warmest - cooling.rise);
    if (wanted > most) scale = most / wanted;
  }
}

void HeatField::advance(double dt, const Cooling* cooling) {
  waiting_ += dt;
  while (waiting_ >= longest_) {
    step(longest_);
    if (cooling != nullptr) cool(*cooling, longest_);
    waiting_ -= longest_;
  }
}

void HeatField::step(double dt) {
  ++steps_;
  if (warm_.empty()) return;
  const Vec3 lambda = Vec3(config_.diffusivity() * dt) / (edges_ * edges_);
  // A backward step spreads heat as exp(-x / sqrt(lambda)) over x cells: to less than a thousandth beyond this margin.
  const Vec3i margin = 2 + floor_int(7.0 * glm::sqrt(lambda));
  const VoxelBox box = VoxelBox{glm::max(warm_.lo - margin, domain_.lo), glm::min(warm_.hi + margin, domain_.hi)};
  conducted_ += box.count();
  for (int turn = 0; turn < 3; ++turn) {
    const int axis = steps_ % 2 == 0 ? turn : 2 - turn;
    sweep(axis, box, lambda[axis]);
  }
  finish(box, dt);
}

double HeatField::implicit_share(double lambda) noexcept {
  constexpr double kLargest = 1.0 / 3.0;
  return lambda <= kLargest ? std::max(0.0, 0.5 - 1.0 / (12.0 * lambda)) : 1.0;
}

double HeatField::edge_flow(std::size_t row, std::size_t lines, std::size_t beside) const noexcept {
  double flow = 0.0;
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t at = row + line * beside;
    flow += static_cast<double>(joint(share_[at], share_[at]) * rise_[at]);
  }
  return flow;
}

// Solves (f + i G) x = (f - e G) rise along all lines of an axis at once, with G x = g- (x - x(-1)) + g+ (x - x(+1)): forward elimination,
// row by row of lines, then back substitution (Thomas). rest_ is 1 - slope of the row before, without the cancellation of that difference.
void HeatField::sweep(int axis, const VoxelBox& box, double lambda) {
  const Vec3i size = box.size(), full = domain_.size();
  const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(full.x),
                                          static_cast<std::size_t>(full.x) * static_cast<std::size_t>(full.y)};
  const int inner = axis == 0 ? 1 : 0, outer = axis == 2 ? 1 : 2;  // lines side by side; planes of lines
  const auto length = static_cast<std::size_t>(size[axis]), lines = static_cast<std::size_t>(size[inner]);
  const std::size_t next = stride[static_cast<std::size_t>(axis)], beside = stride[static_cast<std::size_t>(inner)];
  const bool opens_low = box.lo[axis] == domain_.lo[axis], opens_high = box.hi[axis] == domain_.hi[axis];
  const double share_implicit = implicit_share(lambda);
  const auto implicit = static_cast<float>(share_implicit * lambda), explicit_part = static_cast<float>((1.0 - share_implicit) * lambda);
  slope_.resize(length * lines);
  partial_.resize(length * lines);
  rest_.resize(lines);
  for (int plane = 0; plane < size[outer]; ++plane) {
    const std::size_t origin = domain_.offset_of(box.lo) + static_cast<std::size_t>(plane) * stride[static_cast<std::size_t>(outer)];
    const std::size_t last = origin + (length - 1) * next;
    const auto edge = [&](double weight) {
      if (opens_low) balance_.edge += weight * unit_ * edge_flow(origin, lines, beside);
      if (opens_high) balance_.edge += weight * unit_ * edge_flow(last, lines, beside);
    };
    edge(static_cast<double>(explicit_part));
    for (std::size_t n = 0; n < length; ++n) {
      const std::size_t row = origin + n * next;
      for (std::size_t line = 0; line < lines; ++line) {
        const std::size_t at = row + line * beside;
        const float here = share_[at], old = rise_[at];
        const float low = n > 0 ? joint(here, share_[at - next]) : opens_low ? joint(here, here) : 0.0f;
        const float high = n + 1 < length ? joint(here, share_[at + next]) : opens_high ? joint(here, here) : 0.0f;
        const float old_low = n > 0 ? rise_[at - next] : 0.0f, old_high = n + 1 < length ? rise_[at + next] : 0.0f;
        const float right = here * old - explicit_part * (low * (old - old_low) + high * (old - old_high));
        const float partial_low = n > 0 ? partial_[(n - 1) * lines + line] : 0.0f;
        const float held = here >= kLeastShare ? here + implicit * low * (n > 0 ? rest_[line] : 1.0f) : 1.0f;
        const float pivot = held + implicit * high;
        slope_[n * lines + line] = n + 1 < length ? implicit * high / pivot : 0.0f;
        rest_[line] = held / pivot;
        partial_[n * lines + line] = here >= kLeastShare ? (right + implicit * low * partial_low) / pivot : 0.0f;
      }
    }
    for (std::size_t n = length; n-- > 0;) {
      const std::size_t row = origin + n * next;
      for (std::size_t line = 0; line < lines; ++line) {
        const std::size_t at = row + line * beside;
        const float beyond = n + 1 < length ? rise_[at + next] : 0.0f;
        rise_[at] = partial_[n * lines + line] + slope_[n * lines + line] * beyond;
      }
    }
    edge(static_cast<double>(implicit));
  }
}

void HeatField::finish(const VoxelBox& box, double dt) {
  const auto least = static_cast<float>(config_.least_rise);
  VoxelBox warm;
  float hottest = 0.0f;
  for_each_voxel(box, [&](const Vec3i& cell) {
    const std::size_t here = domain_.offset_of(cell);
    const float rise = rise_[here];
    if (!(std::abs(rise) >= least)) return;
    warm.include(cell);
    hottest = std::max(hottest, rise);
    peak_[here] = std::max(peak_[here], rise);
    dose_[here] += static_cast<float>(thermal_dose(config_.body + static_cast<double>(rise), dt));
  });
  warm_ = warm;
  hottest_ = static_cast<double>(hottest);
}

double HeatField::in_bone() const noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < rise_.size(); ++n) sum += static_cast<double>(share_[n]) * static_cast<double>(rise_[n]);
  return sum * unit_;
}

double HeatField::volume_with_dose(double minutes) const noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < dose_.size(); ++n)
    if (static_cast<double>(dose_[n]) >= minutes) sum += static_cast<double>(share_[n]);
  return sum * edges_.x * edges_.y * edges_.z;
}

double HeatField::highest_peak() const noexcept { return peak_.empty() ? 0.0 : static_cast<double>(*std::ranges::max_element(peak_)); }

}  // namespace burrhole
