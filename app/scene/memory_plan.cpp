#include "app/scene/memory_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/stage/bone_step.h"
#include "core/mesh/mesh_patch.h"
#include "core/tool/cutting_field.h"
#include "core/voxel/bone_history.h"
#include "core/voxel/bone_prefetch.h"
#include "core/voxel/surface_memory.h"

namespace burrhole {
namespace {

// Program, libraries and their tables: resident memory of a run whose scene names no effect, less its volume (Debian 12, amd64).
constexpr std::uint64_t kProgramBytes = 55'000'000;

constexpr std::uint64_t kMasterVoxelBytes = 4 * sizeof(float);  // occupancy, hardness, remaining, density

// What a live run takes besides its arrays: stacks, rows for the session. Measured as kProgramBytes, less a run in lockstep.
constexpr std::uint64_t kThreadBytes = 15'000'000;
// Pages of program, libraries and stacks that a run in lockstep never touches and a live one locks; and those of Mesa's software driver.
constexpr std::uint64_t kLockedBytes = 127'000'000, kLockedDriverBytes = 160'000'000;

/// A voxel of the master window and of what is published of it.
std::uint64_t window_voxel_bytes(const PlanContext& context) {
  return kMasterVoxelBytes + (context.window_voxels > 0 ? publish_bytes(context) / context.window_voxels : 0);
}

/// A window grows while the tool drills: by 18 and 46 % in lockstep. Half is counted, as is reserved; pages that are never touched are not resident,
/// so the figure is an upper bound.
std::uint64_t growth_bytes(const PlanContext& context) {
  return (grown_window_voxels(context.window_voxels) - context.window_voxels) * window_voxel_bytes(context);
}

/// The part of a live run that depends on the scene: windows that may grow by a half, blocks of changed bone, bone read in advance.
std::uint64_t live_bytes(const PlanContext& context, bool locked, bool draws) {
  const std::uint64_t most = most_window_voxels(context.window_voxels) - context.window_voxels;
  const std::uint64_t a_voxel = window_voxel_bytes(context);
  // Occupancy, hardness and a label of the shell round the window: eight voxels thick, and twice that on the side that it moves to.
  constexpr std::uint64_t kAheadVoxelBytes = 2 * sizeof(float) + 1;
  const double edge = std::cbrt(static_cast<double>(context.window_voxels)), wide = edge + 3.0 * BonePrefetch::kAhead;
  const double shell =
      std::min(wide * wide * wide - edge * edge * edge, static_cast<double>(VoxelBox{Vec3i(0), context.bone.dims}.count()));
  std::uint64_t sum = most * a_voxel + kReservedBlocks * sizeof(BlockValues) + static_cast<std::uint64_t>(shell) * kAheadVoxelBytes;
  if (!locked) return sum + kThreadBytes;
  return sum + kLockedBytes + (draws ? kLockedDriverBytes : 0);
}

double in_megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) * 1e-6; }

}  // namespace

std::string MemoryPlan::text() const {
  std::string out = fmt::format("{:.0f} MB:", in_megabytes(peak));
  for (const MemoryItem& item : items)
    if (item.bytes >= 500'000) out += fmt::format(" {} {:.0f},", item.name, in_megabytes(item.bytes));
  if (import > 0) return out + fmt::format(" and while the bone is made {:.0f}", in_megabytes(import));
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
  return bone.bytes + window_voxels * kMasterVoxelBytes;
}

std::uint64_t publish_bytes(const PlanContext& context) noexcept {
  const Needs& needs = context.needs;
  // The paper's grids: density and gradient in leaves, as dense as bone at most.
  constexpr double kNodes = 1.1;
  if (needs.paper_grids)
    return static_cast<std::uint64_t>(kNodes * (sizeof(float) + sizeof(Vec3f)) *
                                      static_cast<double>(VoxelBox{Vec3i(0), context.bone.dims}.count()));
  if (!needs.reads_window) return 0;
  // The copies, and once more what is derived for them and the master window does not hold.
  ContactFields derived = needs.fields;
  derived.density = derived.gradient = false;
  constexpr std::uint64_t kLeapBytes = 3;  // a voxel, in which ContactWords finds leaps
  const std::uint64_t copies = context.live ? 3 : 1, leaps = derived.words ? kLeapBytes : 0;
  const std::uint64_t triangles = needs.fields.triangles != nullptr ? mesh_patch_bytes(context.window_voxels, copies) : 0;
  return context.window_voxels * (copies * bytes_a_voxel(needs.fields) + bytes_a_voxel(derived) + leaps) + triangles;
}

std::uint64_t dense_bone_bytes(const Vec3i& dims, bool soft) noexcept {
  // Occupancy, hardness, labels, soft tissue; of each the nodes round its leaves, and the tables of the upper nodes.
  const double grids = soft ? 4.0 : 3.0;
  constexpr double kNodes = 1.1, kUpperNodes = 0.3e6;
  const auto voxels = static_cast<double>(VoxelBox{Vec3i(0), dims}.count());
  return static_cast<std::uint64_t>(grids * (kNodes * sizeof(float) * voxels + kUpperNodes));
}

std::uint64_t dense_fields_bytes(const Vec3i& dims) noexcept {
  return VoxelBox{Vec3i(0), dims}.count() * (3 * sizeof(float) + 1);  // occupancy, hardness, soft tissue, labels
}

std::uint64_t tool_bytes(const Tool& tool) noexcept {
  const auto mesh = [](const TriangleMesh& m) {
    return (m.positions.size() + m.normals.size()) * sizeof(Vec3f) + m.indices.size() * sizeof(std::uint32_t);
  };
  return tool.shell.size() * (2 * sizeof(Vec3) + 1) + tool.erosion.size() * (sizeof(Vec3) + sizeof(float)) + mesh(tool.mesh) +
         mesh(tool.look);
}

MemoryPlan plan_memory(const Scene& scene, const Tool& tool, const BoneShape& bone, std::uint64_t import, const MemoryRun& run) {
  const Needs needs = scene.effects.needs(scene);
  std::vector<const Tool*> tools{&tool};
  tools.insert(tools.end(), run.tools.begin(), run.tools.end());
  PlanContext context{scene, needs, tool, bone, 0, run.live};
  std::uint64_t of_tools = 0;
  for (const Tool* one : tools) {
    context.window_voxels = std::max(context.window_voxels, window_voxels(scene, needs, *one, bone.bone_from_index));
    of_tools += tool_bytes(*one);
    if (one != &tool && one->cutting) of_tools += one->cutting->bytes();
  }
  MemoryPlan plan;
  plan.import = import;
  plan.items = {{"program", kProgramBytes}, {"volume", volume_bytes(bone, context.window_voxels)}, {"tool", of_tools}};
  if (const std::uint64_t copies = publish_bytes(context); copies > 0) plan.items.push_back({"publish", copies});
  if (needs.reads_window && needs.fields.records)
    plan.items.push_back({"surface records", record_scratch_bytes(grown_window_voxels(context.window_voxels), bone.bone_from_index)});
  if (needs.feels) plan.items.push_back({"coarse distance", CoarseDistance::bytes_for(bone.dims)});
  const std::uint64_t history = run.inputs ? BoneHistoryConfig{}.memory : 0;
  std::uint64_t start = kProgramBytes + bone.bytes + of_tools + history;
  for (const EffectPlans::Item& item : scene.effects.items()) {
    // What an effect keeps for its tool grows to that of the largest.
    std::uint64_t most = 0, most_at_start = 0;
    for (const Tool* one : tools) {
      const PlanRow row = item.plan->row({scene, needs, *one, bone, context.window_voxels});
      most = std::max(most, row.bytes);
      most_at_start = std::max(most_at_start, std::max(row.bytes, row.start_bytes));
    }
    plan.items.push_back({item.table, most});
    start += most_at_start;
  }
  if (history > 0) plan.items.push_back({"history", history});
  if (!run.live) plan.items.push_back({"window growth", growth_bytes(context)});
  if (run.live) plan.items.push_back({"threads", live_bytes(context, run.locked, scene.effects.has("display"))});
  std::uint64_t sum = 0;
  for (const MemoryItem& item : plan.items) sum += item.bytes;
  plan.peak = std::max({sum, start, kProgramBytes + bone.bytes + import});
  return plan;
}

}  // namespace burrhole
