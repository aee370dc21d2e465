#include "app/scene/memory_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/stage/bone_step.h"

namespace burrhole {
namespace {

// Program, libraries and their tables: resident memory of a run whose scene names no effect, less its volume (Debian 12, amd64).
constexpr std::uint64_t kProgramBytes = 55'000'000;

double in_megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) * 1e-6; }

}  // namespace

std::string MemoryPlan::text() const {
  std::string out = fmt::format("{:.0f} MB:", in_megabytes(peak));
  for (const MemoryItem& item : items)
    if (item.bytes >= 500'000) out += fmt::format(" {} {:.0f},", item.name, in_megabytes(item.bytes));
  if (import > 0) return out + fmt::format(" and while the scan is read {:.0f}", in_megabytes(import));
  out.pop_back();
  return out;
}

std::uint64_t window_voxels(const Scene& scene, const Needs& needs, const Tool& tool, const Affine& bone_from_index) {
  const Pose bone_from_tool{rotation_from_z(-scene.approach.axis), scene.approach.entry};
  const int margin = window_margins(needs.fields, bone_from_index).placed;
  const auto box = [&](const Pose& at) { return tool_box(tool, bone_from_index.inverse() * Affine::from_pose(at), margin); };
  if (!(needs.coupling_stiffness > 0.0)) return box(bone_from_tool).count();
  // The window reaches to where the spring to the hand would take the tool.
  const Vec3 stretch = scene.approach.axis * (scene.hand.push / needs.coupling_stiffness);
  return box(bone_from_tool).unite(box({bone_from_tool.rotation, bone_from_tool.translation + stretch})).count();
}

std::uint64_t volume_bytes(const BoneShape& bone, std::uint64_t window_voxels) noexcept {
  constexpr std::uint64_t kFields = 4;  // occupancy, hardness, remaining, density
  return bone.bytes + window_voxels * kFields * sizeof(float);
}

std::uint64_t dense_bone_bytes(const Vec3i& dims) noexcept {
  // Occupancy, hardness, soft tissue, labels; of each the nodes round its leaves, and the tables of the upper nodes.
  constexpr double kGrids = 4.0, kNodes = 1.1, kUpperNodes = 0.3e6;
  const auto voxels = static_cast<double>(VoxelBox{Vec3i(0), dims}.count());
  return static_cast<std::uint64_t>(kGrids * (kNodes * sizeof(float) * voxels + kUpperNodes));
}

MemoryPlan plan_memory(const Scene& scene, const Tool& tool, const BoneShape& bone, std::uint64_t import) {
  const Needs needs = scene.effects.needs(scene);
  const PlanContext context{scene, needs, tool, bone, window_voxels(scene, needs, tool, bone.bone_from_index)};
  MemoryPlan plan;
  plan.import = import;
  plan.items = {{"program", kProgramBytes}, {"volume", volume_bytes(bone, context.window_voxels)}};
  if (needs.feels) plan.items.push_back({"coarse distance", CoarseDistance::bytes_for(bone.dims)});
  for (const EffectPlans::Item& item : scene.effects.items()) plan.items.push_back({item.table, item.plan->row(context).bytes});
  std::uint64_t run = 0;
  for (const MemoryItem& item : plan.items) run += item.bytes;
  plan.peak = std::max(run, kProgramBytes + bone.bytes + import);
  return plan;
}

}  // namespace burrhole
