/// app/bench/render_peer.h: compares ray casting with VTK's fixed-point ray caster, which scripts/peers/vtk_peer.py runs on the same bone
/// and camera in the same run.
///   Thread  main.   Errors  those of scene and renderer; internal if VTK's output cannot be read.
#pragma once

#include "app/bench/bench.h"

namespace burrhole {

/// Adds the rows. Without VTK it prints a line to stderr and adds none; a quick bench skips it.
[[nodiscard]] Status compare_with_vtk(Bench& bench);

}  // namespace burrhole
