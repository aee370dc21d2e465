/// app/effect/display_mesh.h: the keys of [display] for method = "mesh".   Units  SI.   Errors  pushed to the table's Issues.
#pragma once

#include "app/stage/stage_config.h"
#include "app/view/display_config.h"
#include "core/config/toml.h"

namespace burrhole {

/// Reads where the colours of a mesh come from: into `out.textures`, which is empty unless they are drawn, and `out.appearance.labels`. Headers
/// of files of textures are read. @pre method = "mesh"; label_colours was read.
void read_mesh_colors(TableReader& table, const StageConfig& scene, DisplayConfig& out);

}  // namespace burrhole
