#include "app/job/plan.h"

#include <fmt/format.h>

namespace burrhole {
namespace {

PlanRow volume_row(const LoadedScene& loaded, std::uint64_t window) {
  const Vec3i d = loaded.bone->dims();
  return {.table = "volume",
          .clock = Clock::simulation,
          .step = "master window: slide, write back, publish",
          .needs = "bone model",
          .gives = "window, window copy, bone grids",
          .detail = fmt::format("{} x {} x {} voxels of {:.3g} mm", d.x, d.y, d.z, 1e3 * loaded.bone->bone_from_index().mean_edge()),
          .bytes = volume_bytes(shape_of(*loaded.bone), window)};
}

PlanRow hand_row(const LoadedScene& loaded) {
  const HandConfig& hand = loaded.scene.hand;
  const auto detail = [&] {
    if (const auto& feed = loaded.scene.feed_hand)
      return fmt::format("{}, stop at {:.3g} mm",
                         feed->push ? fmt::format("{:.0f} N", *feed->push) : fmt::format("{:.3g} mm/s", 1e3 * feed->feed),
                         1e3 * feed->stop);
    return fmt::format("{:.0f} N, {:.2f} kg, {:.0f} N/m", hand.push, hand.dynamics.mass, hand.dynamics.stiffness);
  };
  return {.table = "hand",
          .clock = Clock::servo,
          .step = "hand motion, integrated exactly over a tick under the latest force",
          .needs = "contact state",
          .gives = "hand motion",
          .detail = detail(),
          .rate_hz = static_cast<double>(loaded.scene.servo_hz)};
}

}  // namespace

Plan make_plan(const LoadedScene& loaded, const EffectRegistry& registry) {
  const Needs needs = loaded.scene.effects.needs(loaded.scene);
  const BoneShape bone = shape_of(*loaded.bone);
  const PlanContext context{loaded.scene, needs, loaded.tool, bone, window_voxels(loaded.scene, needs, loaded.tool, bone.bone_from_index)};
  Plan plan;
  plan.rows = {volume_row(loaded, context.window_voxels), hand_row(loaded)};
  for (const EffectPlans::Item& item : loaded.scene.effects.items()) {
    plan.rows.push_back(item.plan->row(context));
    item.plan->warn(context, plan.warnings);
  }
  for (const EffectEntry& effect : registry)
    if (!loaded.scene.effects.has(effect.table)) plan.not_built.emplace_back(effect.table);
  if (loaded.import)
    for (const std::string& line : loaded.import->scan.assumed) plan.warnings.push_back("[volume] assumed: " + line);
  plan.memory = plan_memory(loaded.scene, loaded.tool, bone, loaded.scan_bytes);
  return plan;
}

}  // namespace burrhole
