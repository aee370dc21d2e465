#include "core/measure/layer_loads.h"

#include <algorithm>

namespace burrhole {

LayerLoads::LayerLoads(const Approach& approach) {
  for (const Approach::Layer& layer : approach.layers) loads_.push_back({.label = layer.label, .from = layer.from, .to = layer.to});
  // The borders lie half way between the samples of the axis.
  for (std::size_t n = 0; n + 1 < loads_.size(); ++n) loads_[n].to = loads_[n + 1].from = 0.5 * (loads_[n].to + loads_[n + 1].from);
  if (loads_.empty()) return;
  loads_.front().from = 0.0;
  loads_.back().to = approach.thickness;
}

void LayerLoads::add(double depth, double force, double time) noexcept {
  constexpr double kLongest = 0.1;  // [s]
  const double dt = time - last_;
  last_ = time;
  if (!(force > kForce && dt > 0.0 && dt <= kLongest)) return;
  const auto here = std::ranges::find_if(loads_, [&](const LayerLoad& l) { return depth >= l.from && depth < l.to; });
  if (here == loads_.end()) return;
  here->time += dt;
  here->impulse += force * dt;
  here->peak = std::max(here->peak, force);
}

std::array<double, 256> removed_by_label(Voxmap& voxmap) {
  std::array<double, 256> out{};
  const VoxelBox box = voxmap.changed_bounds().intersect(voxmap.bone().bounds()), wide = box.grown(1);
  if (box.empty()) return out;
  std::vector<float> before(box.count()), after(box.count()), labels(wide.count());
  voxmap.read_start(box, before);
  voxmap.read_density(box, after);
  voxmap.bone().read_labels(wide, labels);
  const auto label_at = [&](const Vec3i& v) { return static_cast<VoxelLabel>(static_cast<int>(labels[wide.offset_of(v)])); };
  std::size_t n = 0;
  for_each_voxel(box, [&](const Vec3i& v) {
    const double gone = std::max(0.0, static_cast<double>(before[n]) - static_cast<double>(after[n]));
    ++n;
    if (gone <= 0.0) return;
    VoxelLabel label = label_at(v);
    for (const Vec3i& step : {Vec3i(1, 0, 0), Vec3i(-1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, -1, 0), Vec3i(0, 0, 1), Vec3i(0, 0, -1)})
      if (!is_felt(label)) label = label_at(v + step);
    out[static_cast<std::size_t>(is_felt(label) ? label : VoxelLabel::bone)] += gone;
  });
  for (double& volume : out) volume *= voxmap.bone().bone_from_index().cell_volume();
  return out;
}

}  // namespace burrhole
