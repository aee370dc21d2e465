#include "core/drill/region_spin.h"

#include "core/tool/tool_surface.h"
#include "core/voxel/box_parts.h"

namespace burrhole {

RegionSpins::RegionSpins(const Tool& tool, const DrillRegions& regions) : points_(tool.erosion.factors) {
  const auto is_inner = [&](const Vec3& p) { return static_cast<std::uint8_t>(tool.surface->region_at(p) == regions.inner ? 1 : 0); };
  point_inner_.reserve(points_.size());
  for (const Vec3& p : tool.erosion.positions) point_inner_.push_back(is_inner(p));
  if (!tool.cutting) return;
  field_ = std::make_shared<CuttingField>(*tool.cutting);
  nodes_ = field_->factor;
  node_inner_.reserve(nodes_.size());
  if (!nodes_.empty())
    for_each_voxel({Vec3i(0), field_->dims},
                   [&](const Vec3i& v) { node_inner_.push_back(is_inner(field_->origin + field_->pitch * Vec3(v))); });
}

void RegionSpins::set(double inner, double outer, Erosion& erosion) {
  if (now_ == std::array{inner, outer}) return;
  now_ = {inner, outer};
  const std::array<float, 2> share{static_cast<float>(outer), static_cast<float>(inner)};
  if (field_)
    for (std::size_t n = 0; n < nodes_.size(); ++n) field_->factor[n] = nodes_[n] * share[node_inner_[n]];
  scaled_.resize(points_.size());
  for (std::size_t n = 0; n < points_.size(); ++n) scaled_[n] = points_[n] * share[point_inner_[n]];
  erosion.set_factors(scaled_);
}

}  // namespace burrhole
