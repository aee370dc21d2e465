/// core/contact/flank_friction.h: the lateral stiffness of a spinning tool while cutting, so that a flat bit does not skate before it has a
///   bore.
///   Frame  bone, unless stated otherwise.   Units  SI.   Thread  contact; never allocates.
///   Source own derivation. Every engaged element of the cutting surface has a stiffness c along its normal n. Along the push p (unit, out
///   of bone) the elements together have the stiffness K_cut: c sum (n.p)^2 = K_cut. Their lateral stiffness is the tensor c/2 sum n' n'^T
///   with n' the component of n across the push; the factor 1/2 is there because only one of two opposed flanks is in contact. A flat end
///   of radius R engaged by d has K_cut d / (2 R); a ball in contact up to the angle t has K_cut t^2 / 8.
///   Cutting relaxes the displacement: when the surface has receded by a fraction f of the engaged depth, the fraction f of the lateral
///   displacement is cut away with it. This is the feed law v = k d with its own k, laterally. The tool slips at a displacement of half the
///   width of the engaged part (a ball has then climbed out of its dent), and at a lateral force of half the thrust (a flat end of radius
///   R, displaced by R).
#pragma once

#include <array>

#include "core/contact/hold_solver.h"
#include "core/contact/surface_probe.h"
#include "core/tool/tool.h"

namespace burrhole {

class FlankFriction {
 public:
  /// [-] least component of an inward normal along the push. Sine of 3 degrees: a straight flank counts even if the push is slightly
  /// oblique.
  static constexpr double kLeastFacing = -0.05;

  /// Sets the stiffness to zero and the displacement to zero.
  void clear() noexcept;
  /// Starts a period. @param inside cutting points at the tool's pose; points below the surface that face the push count. @param engaged
  /// [m] engagement of the last period. @param stiffness [N/m] K_cut.
  void look(const ProbeHits& inside, const PointShell& shell, const Pose& bone_from_tool, const Vec3& engaged, double stiffness) noexcept;
  /// The two lateral directions as planes at a pose of the same period; `both_ways`, force 0. A plane of yield 0 has no stiffness.
  [[nodiscard]] std::array<HoldPlane, 2> planes(const Pose& bone_from_tool) const noexcept;
  /// Ends a period: relaxes the displacement by cutting, and by slip. @param thrust [N]
  void settle(const Pose& bone_from_tool, const Vec3& engaged, double thrust) noexcept;

  [[nodiscard]] const Vec3& aside() const noexcept { return aside_; }  ///< [m] lateral displacement from the place of cutting

 private:
  /// @returns whether the tool has moved along the push by more than its engagement within the period, so that the flanks are free.
  [[nodiscard]] bool left(const Pose& bone_from_tool) const noexcept;
  [[nodiscard]] Vec3 aside_at(const Pose& bone_from_tool) const noexcept;

  Vec3 push_{0.0, 0.0, 1.0};  // unit, out of bone
  std::array<Vec3, 2> axes_{};
  std::array<double, 2> stiffness_{};  // [N/m] along the axes; 0: no stiffness
  Vec3 arm_{0.0};                      // [m] tool frame: load-weighted centre of the engaged part
  double half_width_ = 0.0;            // [m] of the engaged part, across the push
  Vec3 start_{0.0}, engaged_{0.0};     // [m] the centre and the engagement at the start of the period
  Vec3 aside_{0.0};
  double to_cut_ = 0.0;  // [m] <= 0: distance that the surface has to recede to return to its earlier position
};

}  // namespace burrhole
