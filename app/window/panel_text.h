/// app/window/panel_text.h: the words and figures of the panel, without a window: what a person reads about a run.
///   Units  SI in, text out.   Errors  none.   Thread  any.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/window/window_state.h"

namespace burrhole {

/// @returns the bone ahead of the cutting front [m].
[[nodiscard]] double bone_left(const Approach& approach, const DrillProgress& progress) noexcept;
/// @returns whether so little bone is left that a person should press less.
[[nodiscard]] bool is_near_exit(const Approach& approach, const DrillProgress& progress) noexcept;
/// @returns how far the tip is beyond the bone now [m], where it was drilled through; 0 before, and above.
[[nodiscard]] double beyond_bone(const WindowPlan& plan, const LiveState& live) noexcept;
/// @returns the depth of the tip below the entry, with few digits where it is deep.
[[nodiscard]] std::string depth_text(const DrillProgress& progress);
/// @returns the distance [m] of the tip from the planned axis. Bone left and layer are known along that axis alone.
[[nodiscard]] double beside_plan(const WindowPlan& plan, const LiveState& live);
/// @returns the angle [rad] between the shaft and the normal of the bone's surface at the planned entry.
[[nodiscard]] double angle_to_surface(const WindowPlan& plan, const LiveState& live);
/// @returns the commanded speed, "off", or "clutch open" while the drive turns and [clutch] has released the drill.
[[nodiscard]] std::string drive_text(const WindowPlan& plan, const LiveState& live);
/// @returns the bone left, "through", or "-" where the tip is too far beside the plan.
[[nodiscard]] std::string bone_left_text(const WindowPlan& plan, const LiveState& live);
/// @returns the layer at the cutting front, "air" above the bone, "through" behind it; "beside the plan" where the tip is too far from it.
[[nodiscard]] std::string layer_under_tip(const WindowPlan& plan, const LiveState& live);
/// @returns the volume of bone removed, with few digits where it is large.
[[nodiscard]] std::string removed_text(const LiveState& live);
/// @returns the angle by which the bone is turned from where it was loaded.
[[nodiscard]] std::string turned_text(const LiveState& live);
/// @returns how far the planned entry has moved with the bone.
[[nodiscard]] std::string moved_text(const WindowPlan& plan, const LiveState& live);
/// @returns the distance of the tip from the nearest zone; "inside" with the depth.
[[nodiscard]] std::string zone_text(const ZoneReading& zone);
/// What a person should heed now, one line each.
[[nodiscard]] std::vector<std::string> warnings_of(const WindowPlan& plan, const WindowView& view);
/// Keys and what they do; last those of instruments and of a bone that moves, where the scene has them.
[[nodiscard]] std::vector<std::pair<const char*, const char*>> key_table(const WindowPlan& plan);
/// The same for a watched session.
[[nodiscard]] std::vector<std::pair<const char*, const char*>> watching_keys();
/// @returns a tool's name as a person reads it: "round_burr_4mm" is "round burr 4 mm".
[[nodiscard]] std::string tool_title(const std::string& name);
/// Name and value of the main figures of a run.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> end_figures(const RunSummary& summary);
/// @returns the line broken at blanks alone, so that "40.12 s" is no sentence that ends after "40.", in rows of at most that width. A longer
/// word has a row of its own.
[[nodiscard]] std::string broken_lines(const std::string& line, float width, const std::function<float(const std::string&)>& width_of);
/// Opens a file with the desktop's program for it; where there is one.
/// @returns whether it could be started.
bool open_file(const std::string& path);

}  // namespace burrhole
