/// app/bench/areas.h: the areas there are. Each adds its rows to the bench; an Error means that it could not run.
#pragma once

#include "app/bench/bench.h"

namespace burrhole {

[[nodiscard]] Status bench_contact(Bench& bench);
[[nodiscard]] Status bench_erosion(Bench& bench);
/// The live loops: minutes by the clock, whatever the machine.
[[nodiscard]] Status bench_servo(Bench& bench);
/// Needs the real slices of $BURRHOLE_DATA; without them it says so and adds nothing.
[[nodiscard]] Status bench_import(Bench& bench);
[[nodiscard]] Status bench_render(Bench& bench);  ///< only in a build with the renderer

}  // namespace burrhole
