#include <array>

#include "app/lab/stability_case.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kFelt = 0.05;  // [N] below the perception of a hand; the friction of the devices
constexpr std::array<std::string_view, 15> kNames{
    "not_finite_ticks",     "force_N",        "force_step_N",    "attractive_force_N", "force_without_bone_ms",
    "passivity_deficit_mJ", "cycle_mm",       "ripple_percent",  "penetration_voxel",  "far_side_mm",
    "rest_speed_mm_s",      "drag_mJ_per_mm", "lateral_force_N", "force_in_fault_N",   "fault_missed_percent"};

}  // namespace

std::string_view name_of(StabilityMeasure measure) noexcept { return kNames[static_cast<std::size_t>(measure)]; }

double measure(const StabilityTrace& trace, const StabilityCheck& check, const TraceContext& context) {
  switch (check.measure) {
    case StabilityMeasure::not_finite:
      return ticks_not_finite(trace);
    case StabilityMeasure::force:
      return largest_force(trace, check.span);
    case StabilityMeasure::force_step:
      return largest_force_step(trace, check.span);
    case StabilityMeasure::attractive_force:
      return largest_attractive_force(trace, check.span);
    case StabilityMeasure::force_without_bone:
      return longest_force_without_bone(trace, kFelt) * 1e3;
    case StabilityMeasure::passivity_deficit:
      return passivity_deficit(trace, context.dissipation) * 1e3;
    case StabilityMeasure::cycle:
      return cycle_size(trace, check.span) / kMillimetre;
    case StabilityMeasure::ripple:
      return force_ripple(trace, check.span) * 100.0;
    case StabilityMeasure::penetration:
      return deepest(trace, check.span) / context.voxel_edge;
    case StabilityMeasure::far_side:
      return furthest_beyond(trace, check.span) / kMillimetre;
    case StabilityMeasure::rest_speed:
      return largest_speed(trace, check.span) / kMillimetre;
    case StabilityMeasure::drag:
      return drag_along(trace, check.span);
    case StabilityMeasure::lateral_force:
      return largest_lateral_force(trace, check.span);
    case StabilityMeasure::force_in_fault:
      return largest_force_with(trace, check.faults);
    case StabilityMeasure::ticks_missed:
      return 100.0 * (1.0 - share_with(trace, check.span, check.faults));
  }
  return 0.0;
}

double bound_of(const StabilityCheck& check, const TraceContext& context) noexcept {
  return check.measure == StabilityMeasure::force_without_bone ? check.bound + context.grace * 1e3 : check.bound;
}

}  // namespace burrhole
