/// core/contact/side_grip.h: how bone holds a spinning tool sideways where it is engaged, so that a flat bit does not skate before it has a
///   bore.
///   Frame  bone, but for what is named otherwise.   Units  SI.   Thread  contact; never allocates.
///   Source own derivation. Every engaged piece of the cutting surface presses on bone along its own normal n, by c for each metre that it
///   is moved into it; c is such that along the push p (unit, out of bone) all of them together are K_cut: c sum (n.p)^2 = K_cut. Sideways
///   the same pieces give the tensor c/2 sum n' n'^T, n' the part of n across the push; half, since of two opposed flanks only one presses.
///   A flat end of radius R engaged by d has K_cut d / (2 R), a ball that touches up to the angle t K_cut t^2 / 8.
///   It is let go as bone is cut: when the surface has receded by a part f of what is engaged, f of the way aside is cut away with it,
///   which is the feed law v = k d with its own k, sideways. It slips when the tool is moved aside by the half width of what is engaged (a
///   ball has then climbed out of its dent), and at half the thrust (a flat end of radius R, moved by R).
#pragma once

#include <array>

#include "core/contact/hold_solver.h"
#include "core/contact/surface_probe.h"
#include "core/tool/tool.h"

namespace burrhole {

class SideGrip {
 public:
  /// [-] along the push, of inward normals: less is relieved. Sine of 3 degrees: a straight flank is one still while the push leans a
  /// little.
  static constexpr double kLeastFacing = -0.05;

  /// Holds nothing, and forgets how far aside the tool is.
  void clear() noexcept;
  /// At the start of a period. @param inside cutting points at the tool's true pose; those under the surface that face the push count.
  /// @param engaged [m] of the period before. @param stiffness [N/m] K_cut.
  void look(const ProbeHits& inside, const PointShell& shell, const Pose& bone_from_tool, const Vec3& engaged, double stiffness) noexcept;
  /// The two directions held, at a pose of the same period; `both_ways`, force 0. Of yield 0: not held.
  [[nodiscard]] std::array<HoldPlane, 2> planes(const Pose& bone_from_tool) const noexcept;
  /// At the end of a period: lets go what was cut, and slips. @param thrust [N]
  void settle(const Pose& bone_from_tool, const Vec3& engaged, double thrust) noexcept;

  [[nodiscard]] const Vec3& aside() const noexcept { return aside_; }  ///< [m] from where it is cut, across the push

 private:
  /// Within the period the tool has gone further along the push than it was engaged: what held is no more round it.
  [[nodiscard]] bool left(const Pose& bone_from_tool) const noexcept;
  [[nodiscard]] Vec3 aside_at(const Pose& bone_from_tool) const noexcept;

  Vec3 push_{0.0, 0.0, 1.0};  // unit, out of bone
  std::array<Vec3, 2> axes_{};
  std::array<double, 2> stiffness_{};  // [N/m] along the axes; 0: not held
  Vec3 arm_{0.0};                      // [m] tool frame: middle of what is engaged, by load
  double half_width_ = 0.0;            // [m] of what is engaged, across the push
  Vec3 start_{0.0}, engaged_{0.0};     // [m] the middle and the engagement at the start of the period
  Vec3 aside_{0.0};
  double to_cut_ = 0.0;  // [m] <= 0: how far the surface that is felt has to recede until it is where it was before
};

}  // namespace burrhole
