/// app/effect/display_skin.h: the keys of [display] for the skin of a whole head, and the body that it is made of.   Units  SI.
///   Errors  pushed to the table's Issues; those of reading a scan.
#pragma once

#include "app/stage/stage_config.h"
#include "app/view/display_config.h"
#include "core/base/result.h"
#include "core/config/toml.h"

namespace burrhole {

/// Reads the skin into `out.skin`. @pre method, shading and drape were read.
void read_skin(TableReader& table, const StageConfig& scene, DisplayConfig& out);

/// Sets the body of the skin. The skin of a scan is found in the scan, which is read again: the bone model does not have it.
[[nodiscard]] Status find_skin(const VolumeScene& volume, SkinConfig& skin);

}  // namespace burrhole
