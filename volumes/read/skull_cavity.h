/// volumes/read/skull_cavity.h: the space inside a skull in a scan, on cubes of a few millimetres.
///   Frame  bone frame.   Units  SI.   Errors  none: a scan without a cavity has no cube of it.   Thread  any, once created.
///   Source own derivation. Bone is its largest connected part, so that a headrest encloses nothing. A cube without bone is enclosed if bone is
///          met in most of the 26 directions to its neighbours, of those in which the scan shows it: a direction that leaves the scan through
///          a face with bone is not counted, since the bone is cut there. The cavity is the largest connected part of the enclosed cubes, of air
///          or of tissue.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/geometry.h"
#include "volumes/read/scan.h"

namespace burrhole {

/// Limits of the classification, in the unit of the scan's values.
struct TissueLevels {
  double air = 0.0;   ///< [unit of the scan's values] below: air
  double bone = 0.0;  ///< [unit of the scan's values] from here on: bone
};

class SkullCavity {
 public:
  static constexpr double kCube = 2.5e-3;       ///< [m] least edge of a cube
  static constexpr double kLeastShare = 0.8;    ///< [-] of the directions
  static constexpr double kLeastVolume = 2e-5;  ///< [m^3] 20 ml: a smaller space is a sinus, not the inside of a skull
  [[nodiscard]] static SkullCavity find(const Scan& scan, const TissueLevels& levels);

  /// @returns whether the cube at a point belongs to the cavity.
  [[nodiscard]] bool holds(const Vec3& p_bone) const noexcept;
  [[nodiscard]] bool empty() const noexcept { return cubes_ == 0; }
  [[nodiscard]] double volume() const noexcept { return static_cast<double>(cubes_) * cube_ * cube_ * cube_; }  ///< [m^3]

 private:
  enum : std::uint8_t { kBone = 1, kAir = 2, kEnclosed = 4, kCavity = 8 };
  SkullCavity() = default;
  void sort_voxels(const Scan& scan, const TissueLevels& levels);
  void find_enclosed();
  void take_largest();
  [[nodiscard]] VoxelBox bounds() const noexcept { return {Vec3i(0), dims_}; }

  Vec3 origin_{0.0};  // [m] centre of cube 0
  double cube_ = kCube;
  Vec3i dims_{0};
  std::vector<std::uint8_t> state_;
  std::size_t cubes_ = 0;
};

}  // namespace burrhole
