/// app/effect/dura_looks.h: the colours of dura, of the edge of a rent in it, and of the brain that is seen through one.
///   Frame  bone frame, at rest: patterns move with the tissue.   Units  m.   Errors  none.   Thread  any.
///   Source  own; colours are chosen by eye, vessels and fibres as in shaders/tissue.glsl.
#pragma once

#include "app/view/view.h"
#include "core/base/geometry.h"

namespace burrhole {

/// 0 below lo, 1 above hi, with slope 0 at both.
[[nodiscard]] double smooth_step(double lo, double hi, double x);
/// [-] 0..1, smooth over cells of edge 1. As shaders/noise.glsl.
[[nodiscard]] double tissue_noise(const Vec3& x);

/// A point of the outer face. @param depth [m] below its place at rest: a pit is darker. @param lip 0..1, 1 at the edge of a rent, which is paler.
[[nodiscard]] Rgba8 dura_color(const Vec3& p, double depth, double lip);
/// The inner face, which a cut of the picture shows as the section, and the edge of a rent between both faces. @param bloody 0..1 how much of it blood may stain.
[[nodiscard]] Rgba8 dura_inside_color(const Vec3& p, double bloody);

/// How far [m] the surface of the brain lies below its level: sulci.
[[nodiscard]] double sulcus_depth(const Vec3& p);
/// The surface of the brain under arachnoid and pia, with their vessels. @param open 0..1 how much light the rent lets onto it.
[[nodiscard]] Rgba8 brain_color(const Vec3& p, double open);
inline constexpr std::uint8_t kBrainShine = 235;  ///< of brain_color()

}  // namespace burrhole
