/// core/heat/heat_figures.h: what a run reports of a heat field. Each is a mean or an integral, so that it has a limit as cells get smaller.
///   Frame  cells.   Units  SI; temperatures as the rise above the body's [K]; dose [min].   Errors  none.   Thread  any; they allocate.
#pragma once

#include "core/heat/heat_field.h"

namespace burrhole {

/// @returns the volume [m^3] of bone with at least that dose [min]. The logarithm of the dose is linear in each cell's bone, which lies on the
/// side where the cells beside it are fuller.
[[nodiscard]] double volume_with_dose(const HeatField& field, double minutes);

/// @returns the mean of the highest rises [K] of the hottest bone that is left, of that volume [m^3] > 0; of all bone if less is left. A ledge
/// that is cut ever thinner has no largest rise: it warms by the rise of a steady cut for each factor e of its thickness.
[[nodiscard]] double hottest_mean(const HeatField& field, double volume);

/// @returns the dose [min] at the free face of bone below a cell, from the doses of the cell and of the next one inwards: heat does not pass
/// the face, so the rise has its smallest or largest value there, and the means of two layers determine a parabola.
/// @param inwards the step [cells] from the face into bone.
[[nodiscard]] double dose_at_face(const HeatField& field, const Vec3i& cell, const Vec3i& inwards);

}  // namespace burrhole
