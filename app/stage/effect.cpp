#include "app/stage/effect.h"

#include <algorithm>

namespace burrhole {

EffectPlans& EffectPlans::operator=(const EffectPlans& other) {
  std::vector<Item> copies;
  for (const Item& item : other.items_) copies.push_back({item.table, item.plan->clone()});
  items_ = std::move(copies);
  return *this;
}

bool EffectPlans::remove(std::string_view table) {
  return std::erase_if(items_, [&](const Item& item) { return item.table == table; }) > 0;
}

bool EffectPlans::has(std::string_view table) const noexcept {
  return std::ranges::any_of(items_, [&](const Item& item) { return item.table == table; });
}

Needs EffectPlans::needs(const StageConfig& config) const {
  Needs out;
  out.servo = config.servo;
  for (const Item& item : items_) item.plan->add_needs(config, out);
  return out;
}

DrillingWay drilling_way(const StageConfig& config, const BoneShape& bone) {
  const Vec3 &axis = config.approach.axis, &entry = config.approach.entry;
  const Affine index_from_bone = bone.bone_from_index.inverse();
  double depth = config.feed_hand ? config.feed_hand->stop : config.hand.reach;
  if (bone.thickness > 0.0) {
    depth = std::min(depth, bone.thickness);
  } else {
    const Vec3 from = index_from_bone * entry, step = index_from_bone.linear * axis;
    for (std::size_t n = 0; n < 3; ++n) {
      const double end = step[n] > 0.0 ? static_cast<double>(bone.dims[n]) : 0.0;
      if (step[n] != 0.0) depth = std::min(depth, std::max(0.0, (end - from[n]) / step[n]));
    }
  }
  return {index_from_bone * Affine::from_pose({rotation_from_z(-axis), entry}), index_from_bone.linear * (axis * depth)};
}

int read_rate(TableReader& table, const StageConfig& stage, int fallback, int least, const char* about) {
  const int rate = static_cast<int>(table.integer("rate_hz", fallback, least, 20000, about));
  if (stage.servo_hz % rate != 0) table.fault("rate_hz", "must divide servo_hz = " + std::to_string(stage.servo_hz));
  return rate;
}

}  // namespace burrhole
