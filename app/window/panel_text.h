/// app/window/panel_text.h: the words and figures of the panel, without a window: what a person reads about a run.
///   Units  SI in, text out.   Errors  none.   Thread  any.
#pragma once

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
/// @returns the depth of the tip below the entry, with few digits where it is deep.
[[nodiscard]] std::string depth_text(const DrillProgress& progress);
/// @returns the layer at the cutting front, "air" above the bone, "through" behind it.
[[nodiscard]] std::string layer_under_tip(const Approach& approach, const LiveState& live);
/// What a person should heed now, one line each.
[[nodiscard]] std::vector<std::string> warnings_of(const WindowPlan& plan, const WindowView& view);
/// Keys and what they do.
[[nodiscard]] std::span<const std::pair<const char*, const char*>> key_table();
/// @returns a tool's name as a person reads it: "round_burr_4mm" is "round burr 4 mm".
[[nodiscard]] std::string tool_title(const std::string& name);
/// Name and value of the main figures of a run.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> end_figures(const RunSummary& summary);
/// Opens a file with the desktop's program for it; nothing where there is none.
void open_file(const std::string& path);

}  // namespace burrhole
