#include "core/drill/energy.h"

#include <cmath>
#include <limits>

#include "core/base/portable_math.h"

namespace burrhole {

double turns_for_work(std::span<const EnergyTerm> terms, double work) noexcept {
  if (!(work > 0.0)) return 0.0;
  double worth = 0.0;
  for (const EnergyTerm& term : terms) worth += term.worth;
  if (!(worth > work)) return std::numeric_limits<double>::infinity();
  double k = 0.0;
  for (int n = 0; n < 100; ++n) {
    double missing = work, slope = 0.0;
    for (const EnergyTerm& term : terms) {
      const double keep = portable_exp(-k * term.rate);
      missing -= term.worth * (1.0 - keep);
      slope += term.worth * term.rate * keep;
    }
    if (missing <= 1e-12 * work || !(slope > 0.0)) break;
    k += missing / slope;
  }
  return k;
}

double rubbing_radius(const ErosionPoints& points) noexcept {
  double weight = 0.0, moment = 0.0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Vec3& p = points.positions[n];
    weight += static_cast<double>(points.factors[n]);
    moment += static_cast<double>(points.factors[n]) * std::sqrt(p.x * p.x + p.y * p.y);
  }
  return weight > 0.0 ? moment / weight : 0.0;
}

double cutting_torque(double cutting_ratio, double force, double radius) noexcept { return cutting_ratio * force * radius; }

std::uint32_t EngagedScatter::gather(const Voxmap& voxmap, const ErosionPoints& points, const Affine& index_from_tool, double cell_share,
                                     std::vector<Engaged>& engaged) {
  const MasterWindow& window = voxmap.window();
  if (slot_.size() != window.box.count()) slot_.assign(window.box.count(), 0);
  const VoxelBox allowed = window.erodible_box();
  const Vec3 lowest(allowed.lo), highest(allowed.hi);
  std::uint32_t outside = 0;
  sums_.clear();
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Vec3& p = points.positions[n];
    const Vec3 place = index_from_tool * p + 0.5;
    if (!(glm::all(glm::greaterThanEqual(place, lowest)) && glm::all(glm::lessThan(place, highest)))) {
      ++outside;
      continue;
    }
    const std::size_t at = window.box.offset_of(floor_int(place));
    if (window.density[at] == 0.0f || window.remaining[at] == 0.0f || points.factors[n] == 0.0f) continue;
    if (slot_[at] == 0) {
      sums_.push_back({static_cast<std::uint32_t>(at), 0.0, 0.0});
      slot_[at] = static_cast<std::uint32_t>(sums_.size());
    }
    Sum& sum = sums_[slot_[at] - 1];
    const auto e = static_cast<double>(points.factors[n]);
    sum.exposure += e;
    sum.moment += e * std::sqrt(p.x * p.x + p.y * p.y);
  }
  for (const Sum& sum : sums_) {
    slot_[sum.at] = 0;
    engaged.push_back(
        {.at = sum.at, .exposure = static_cast<float>(sum.exposure * cell_share), .radius = static_cast<float>(sum.moment / sum.exposure)});
  }
  return outside;
}

}  // namespace burrhole
