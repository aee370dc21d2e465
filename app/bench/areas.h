/// app/bench/areas.h: the areas of the benchmark. Each adds its rows to the bench.
///   Thread  main.   Errors  those of loading its scene or data; unavailable without OpenGL. A disagreement of results is no Error.
#pragma once

#include "app/bench/bench.h"

namespace burrhole {

[[nodiscard]] Status bench_contact(Bench& bench);
[[nodiscard]] Status bench_erosion(Bench& bench);
/// The account of one bone step.
[[nodiscard]] Status bench_step(Bench& bench);
/// The live loops, in real time: takes minutes on every machine.
[[nodiscard]] Status bench_servo(Bench& bench);
/// Needs the real slices of $BURRHOLE_DATA; without them it prints a line and adds no row.
[[nodiscard]] Status bench_import(Bench& bench);
/// Ball pivoting: full, and after a cut.
[[nodiscard]] Status bench_mesh(Bench& bench);
/// What depends on the edge of the volume; only in a build with the renderer. Also writes growth.svg.
[[nodiscard]] Status bench_growth(Bench& bench);
[[nodiscard]] Status bench_render(Bench& bench);  ///< only in a build with the renderer

}  // namespace burrhole
