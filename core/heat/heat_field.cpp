#include "core/heat/heat_field.h"

#include <algorithm>
#include <cmath>

#include "core/heat/thermal_dose.h"

namespace burrhole {
namespace {

constexpr std::array<Vec3i, 3> kAxes{Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1)};

/// @returns the conductance between two cells over that of full bone. @param share of a cell. @param inverse one over its largest share.
float joint(float share_a, float inverse_a, float share_b, float inverse_b) noexcept {
  const float a = share_a * inverse_a, b = share_b * inverse_b, fuller = std::max(a, b);
  return share_a >= HeatField::kLeastShare && share_b >= HeatField::kLeastShare ? 2.0f * fuller * fuller / (a * inverse_a + b * inverse_b)
                                                                                : 0.0f;
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
      dose_(domain.count()),
      inverse_whole_(domain.count()),
      slot_(domain.count()),
      source_(domain.count()),
      cut_(domain.count()) {}

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
    if (after > 0.0f && !(after * inverse_whole_[here] < 1.0f && inverse_whole_[here] > 0.0f)) inverse_whole_[here] = 1.0f / after;
    const double heat = before >= kLeastShare ? unit_ * static_cast<double>(before) * static_cast<double>(rise_[here]) : 0.0;
    if (after < before) losses_.push_back({cell, before - after});
    if (after < kLeastShare) {
      balance_.chips += heat;
      rise_[here] = peak_[here] = dose_[here] = 0.0f;
    } else if (after < before) {
      balance_.chips += heat * static_cast<double>((before - after) / before);
    } else {
      rise_[here] = static_cast<float>(heat / (unit_ * static_cast<double>(after)));
      if (slot_[here] != 0) {  // what is back carries nothing away
        double& cut = heatings_[slot_[here] - 1].share;
        cut = std::max(0.0, cut - static_cast<double>(after - before));
      }
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
    std::uint32_t& slot = slot_[domain_.offset_of(loss.cell)];
    if (slot == 0) {
      heatings_.push_back({loss.cell, 0.0, 0.0});
      slot = static_cast<std::uint32_t>(heatings_.size());
    }
    heatings_[slot - 1].share += static_cast<double>(loss.share);
    heatings_[slot - 1].joule += joule * static_cast<double>(loss.share) / lost;
  }
  losses_.clear();
}

// The area of the cut surface follows from the cells beside: across an axis they differ in what they hold by the part of the face that the surface
// crosses. A steeper surface is larger.
Vec3 HeatField::cut_surface(const Vec3i& cell) const noexcept {
  Vec3 area(0.0);
  const double volume = edges_.x * edges_.y * edges_.z;
  for (int n = 0; n < 3; ++n) {
    const Vec3i& step = kAxes[static_cast<std::size_t>(n)];
    area[n] = std::abs(filled_beside(cell, cell + step) - filled_beside(cell, cell - step)) * volume / edges_[n];
  }
  return area;
}

// Heat enters through the cut surface. Over its area, half the bone of the cell is the way to its mean.
double HeatField::half_resistance(const Vec3i& cell) const noexcept {
  const double volume = edges_.x * edges_.y * edges_.z;
  const Vec3 area = cut_surface(cell);  // across the axis on which they differ most, the cells beside differ over one cell, else over two
  const int across = area.x >= area.y && area.x >= area.z ? 0 : area.y >= area.z ? 1 : 2;
  double square = std::pow(std::max(area[across], volume / edges_[across]), 2.0);
  for (int n = 0; n < 3; ++n)
    if (n != across) square += std::pow(0.5 * area[n], 2.0);
  return volume * static_cast<double>(inverse_whole_[domain_.offset_of(cell)]) / (2.0 * config_.conductivity * square);
}

double HeatField::outflow(const Vec3i& cell) const noexcept {
  const std::size_t here = domain_.offset_of(cell);
  const double volume = edges_.x * edges_.y * edges_.z;
  double sum = 0.0;
  for (int n = 0; n < 3; ++n)
    for (const Vec3i& next : {cell - kAxes[static_cast<std::size_t>(n)], cell + kAxes[static_cast<std::size_t>(n)]}) {
      if (!domain_.contains(next)) continue;
      const std::size_t there = domain_.offset_of(next);
      const float conducts = joint(share_[here], inverse_whole_[here], share_[there], inverse_whole_[there]);
      sum += config_.conductivity * volume / (edges_[n] * edges_[n]) * static_cast<double>(conducts * (rise_[here] - rise_[there]));
    }
  return sum;
}

HeatField::Behind HeatField::behind(const Vec3i& cell) const noexcept {
  Vec3 inwards(0.0);
  for_each_voxel(VoxelBox{cell, cell + 1}.grown(1).intersect(domain_), [&](const Vec3i& at) {
    if (share(at) >= kLeastShare) inwards += Vec3(at - cell) * filled(at);
  });
  inwards /= edges_;
  Behind out;
  double sum = 0.0;
  for (int n = 0; n < 3; ++n) {
    const Vec3i step = kAxes[static_cast<std::size_t>(n)];
    const Vec3i at = cell + (inwards[n] > 0.0 ? step : -step);
    out.cells[static_cast<std::size_t>(n)] = at;
    if (share(at) >= kLeastShare) sum += out.part[n] = inwards[n] * inwards[n] * static_cast<double>(share(at));
  }
  if (sum > 0.0) out.part /= sum;
  return out;
}

void HeatField::put(const Vec3i& cell, double joule, const Vec3& along) {
  sources_.push_back({domain_.offset_of(cell), static_cast<float>(joule / unit_), along});
  warm_.include(cell);
}

void HeatField::place_behind(const Vec3i& cell, const Behind& behind, double joule) {
  if (behind.part != Vec3(0.0)) {
    for (int n = 0; n < 3; ++n)
      if (behind.part[n] > 0.0) {
        Vec3 along(0.0);
        along[n] = 1.0;
        put(behind.cells[static_cast<std::size_t>(n)], joule * behind.part[n], along);
      }
    return;
  }
  const VoxelBox around = VoxelBox{cell, cell + 1}.grown(1).intersect(domain_);
  double bone = 0.0;
  for_each_voxel(around, [&](const Vec3i& at) { bone += share(at) >= kLeastShare ? static_cast<double>(share(at)) : 0.0; });
  if (!(bone > 0.0)) {
    balance_.unplaced += joule;
    return;
  }
  for_each_voxel(around, [&](const Vec3i& at) {
    if (share(at) >= kLeastShare) put(at, joule * static_cast<double>(share(at)) / bone, Vec3(1.0 / 3.0));
  });
}

void HeatField::remember(std::size_t at, double share) {
  if (share > 0.0) removals_.push_back({at, static_cast<float>(share), rise_[at]});
}

void HeatField::settle(double part) {
  for (Heating& heating : heatings_) {
    const std::size_t here = domain_.offset_of(heating.cell);
    // Bone left at the mean temperature of its cell: what it carried away above that is taken from the heat of cutting.
    const double fill = (static_cast<double>(share_[here]) + 0.5 * heating.share) * static_cast<double>(inverse_whole_[here]);
    const double power = heating.joule / heating_,
                 onwards = share_[here] >= kLeastShare ? std::clamp(outflow(heating.cell), 0.0, power) : power;
    const double warmer = fill * half_resistance(heating.cell) * (2.0 * power + onwards) / 3.0;
    const double taken = std::min(unit_ * heating.share * warmer, heating.joule), joule = part * (heating.joule - taken);
    balance_.chips += taken;
    if (share_[here] >= kLeastShare) {
      const Vec3 area = cut_surface(heating.cell);
      const double square = glm::dot(area, area);
      if (square > 0.0)
        put(heating.cell, joule, area * area / square);
      else  // the cells on both sides hold alike, as where an undo brought the bone back
        add(here, heating.cell, joule);
      remember(here, heating.share);
      cut_[here] = 0.5f * static_cast<float>(heating.share);
    } else {  // the bone behind it is as warm as the rest of it was
      const Behind next = behind(heating.cell);
      place_behind(heating.cell, next, joule);
      for (int n = 0; n < 3; ++n)
        if (next.part[n] > 0.0) remember(domain_.offset_of(next.cells[static_cast<std::size_t>(n)]), heating.share * next.part[n]);
    }
    heating.share = 0.0;
    heating.joule -= taken + joule;
    if (part == 1.0) slot_[here] = 0;
  }
  if (part < 1.0) return;
  heatings_.clear();
  heating_ = 0.0;
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
  heating_ += dt;
  for (auto left = static_cast<std::uint64_t>(waiting_ / longest_); left > 0; --left) {
    settle(1.0 / static_cast<double>(left));
    conduct(longest_);
    if (cooling != nullptr) cool(*cooling, longest_);
    waiting_ -= longest_;
  }
}

void HeatField::step(double dt) {
  heating_ += dt;
  settle(1.0);
  conduct(dt);
}

void HeatField::conduct(double dt) {
  ++steps_;
  if (warm_.empty()) return;
  const Vec3 lambda = Vec3(config_.diffusivity() * dt) / (edges_ * edges_);
  // A backward step spreads heat as exp(-x / sqrt(lambda)) over x cells: to less than a thousandth beyond this margin.
  const Vec3i margin = 2 + floor_int(7.0 * glm::sqrt(lambda));
  const VoxelBox box = VoxelBox{glm::max(warm_.lo - margin, domain_.lo), glm::min(warm_.hi + margin, domain_.hi)};
  conducted_ += box.count();
  // Along the axis with most of the heat second in each order: heat that enters with the last sweep is not spread along the other axes yet.
  Vec3 heat(0.0);
  for (const Source& source : sources_) heat += source.along * static_cast<double>(source.amount);
  if (heat != Vec3(0.0)) middle_ = heat.x > heat.y && heat.x > heat.z ? 0 : heat.y > heat.z ? 1 : 2;
  const int low = middle_ == 0 ? 1 : 0, high = middle_ == 2 ? 1 : 2;
  for (const int axis : steps_ % 2 == 0 ? std::array{low, middle_, high} : std::array{high, middle_, low}) {
    for (const Source& source : sources_) source_[source.at] += source.amount * static_cast<float>(source.along[axis]);
    sweep(axis, box, lambda[axis]);
    for (const Source& source : sources_) source_[source.at] = 0.0f;
  }
  sources_.clear();
  catch_up();
  finish(box, dt);
}

double HeatField::implicit_share(double lambda) noexcept {
  constexpr double kLargest = 1.0 / 3.0;
  return lambda <= kLargest ? std::max(0.0, 0.5 - 1.0 / (12.0 * lambda)) : 1.0;
}

// Bone left during a step at the temperature of its cell before it: at the mean of that and of the one after it, it takes the rest now.
void HeatField::catch_up() {
  for (const Removal& removal : removals_) {
    const std::size_t here = removal.at;
    cut_[here] = 0.0f;
    const float share = std::min(removal.share, share_[here]), rest = 0.5f * (rise_[here] - removal.rise) * share;
    rise_[here] -= rest / share_[here];
    balance_.chips += unit_ * static_cast<double>(rest);
  }
  removals_.clear();
}

double HeatField::edge_flow(std::size_t row, std::size_t lines, std::size_t beside) const noexcept {
  double flow = 0.0;
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t at = row + line * beside;
    flow += static_cast<double>(joint(share_[at], inverse_whole_[at], share_[at], inverse_whole_[at]) * rise_[at]);
  }
  return flow;
}

// Solves (f + I) x = (f - E) rise along all lines of an axis at once, with I x = i- (x - x(-1)) + i+ (x - x(+1)), E likewise: forward elimination,
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
  const auto all = static_cast<float>(lambda), explicit_part = static_cast<float>((1.0 - share_implicit) * lambda);
  slope_.resize(length * lines);
  partial_.resize(length * lines);
  for (std::vector<float>* scratch : {&rest_, &implicit_, &explicit_}) scratch->resize(lines);
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
        const float here = share_[at], old = rise_[at], inverse = inverse_whole_[at];
        const float own = n == 0 && opens_low ? joint(here, inverse, here, inverse) : 0.0f;
        const float implicit_low = n > 0 ? implicit_[line] : (all - explicit_part) * own;
        const float explicit_low = n > 0 ? explicit_[line] : explicit_part * own;
        const bool inside = n + 1 < length;
        const float beyond = opens_high ? here : 0.0f;  // the last cell of the box
        const float next_share = inside ? share_[at + next] : beyond, next_inverse = inside ? inverse_whole_[at + next] : inverse;
        const float high = inside ? joint(here + cut_[at], inverse, next_share + cut_[at + next], next_inverse)
                                  : joint(here, inverse, next_share, next_inverse);
        // In cut bone at most what makes no new extremum, half the smaller share; in whole bone it always is.
        const float explicit_high = std::min(explicit_part * high, 0.5f * std::min(here, next_share));
        const float implicit_high = all * high - explicit_high;
        const float old_low = n > 0 ? rise_[at - next] : 0.0f, old_high = inside ? rise_[at + next] : 0.0f;
        const float right = here * old + source_[at] - (explicit_low * (old - old_low) + explicit_high * (old - old_high));
        const float partial_low = n > 0 ? partial_[(n - 1) * lines + line] : 0.0f;
        const float held = here >= kLeastShare ? here + implicit_low * (n > 0 ? rest_[line] : 1.0f) : 1.0f;
        const float pivot = held + implicit_high;
        slope_[n * lines + line] = inside ? implicit_high / pivot : 0.0f;
        rest_[line] = held / pivot;
        partial_[n * lines + line] = here >= kLeastShare ? (right + implicit_low * partial_low) / pivot : 0.0f;
        implicit_[line] = implicit_high;
        explicit_[line] = explicit_high;
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
    edge(static_cast<double>(all - explicit_part));
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
  double waits = 0.0;
  for (const Heating& heating : heatings_) waits += heating.joule;
  return sum * unit_ + waits;
}

double HeatField::highest_peak() const noexcept { return peak_.empty() ? 0.0 : static_cast<double>(*std::ranges::max_element(peak_)); }

}  // namespace burrhole
