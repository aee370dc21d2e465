/// tests/core/contact/surface_support.h: a tool on springs of its own pressed on bone as shipped until it rests.
///   Units  SI.
#pragma once

#include <limits>

#include "shipped_bone.h"

namespace burrhole::contact_test {

inline constexpr double kFineEdge = 0.25e-3;  ///< [m]
inline constexpr double kTick = 1e-3;         ///< [s]
inline constexpr double kStiffness = 5000.0;  ///< [N/m]

/// Turning locked: the closed form is of translations.
inline ConstrainedToolConfig locked() {
  ConstrainedToolConfig config;
  config.coupling_stiffness = kStiffness;
  config.turn_stiffness = std::numeric_limits<double>::infinity();
  return config;
}

inline PhantomSpec spec_of(PhantomKind kind) {
  PhantomSpec spec;
  spec.kind = kind;
  spec.pitch = kFineEdge;
  spec.extent = Vec3(0.014, 0.014, 0.012);
  spec.above = 0.004;
  spec.thickness = 0.006;
  return spec;
}

/// The hand comes from 0.3 mm above, then rests until the springs have.
inline Vec3 settled_force(ConstrainedTool& tool, const SurfaceView& view, const Pose& start, const Vec3& way) {
  tool.place(start);
  for (int tick = 0; tick < 80; ++tick) {
    const double part = std::min(1.0, tick / 20.0);
    (void)tool.step(view, {{start.rotation, start.translation + way * part}, tick < 20 ? way / (20.0 * kTick) : Vec3(0.0)}, kTick);
  }
  return tool.state().on_hand.force;
}

}  // namespace burrhole::contact_test
