/// app/job/earlier_run.h: whether the results in a folder are those of the same run, which may be repeated there.
///   Errors  bad_input with the folder as place.   Thread  any; reads files and, if all else is the same, all of the bone.
#pragma once

#include <string>

#include "app/scene/load.h"
#include "core/base/result.h"

namespace burrhole {

/// Results of another run are likely wanted still. A run is the same if its scene's file is at the same place (place_of_scene()), and
/// overrides, texts of scene and tool, and bone are those of the summary.json there; how it is driven (hand, inputs, window) may differ.
/// @param shipped_scenes see DrillJob. @returns an error that says what differs; nothing for a folder without results.
[[nodiscard]] Status check_earlier_run(const LoadedScene& loaded, const std::string& folder, const std::string& shipped_scenes);

}  // namespace burrhole
