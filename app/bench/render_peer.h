/// app/bench/render_peer.h: the rows beside VTK's fixed-point ray caster, which scripts/peers/vtk_peer.py runs on the same bone from the same
/// camera in the same run.
#pragma once

#include "app/bench/bench.h"

namespace burrhole {

/// Says on stderr that VTK is not installed, and adds nothing, where it is not. Nothing in a quick bench either.
[[nodiscard]] Status compare_with_vtk(Bench& bench);

}  // namespace burrhole
