/// app/view/assumed_brain.h: dura and brain under the bone of a scan, for pictures alone. The bone model of a scan has no soft tissue; without
///   one, a section through a skull is hollow. They are assumed, not measured: dura lies on the inner surface of the bone as loaded, brain
///   below it.
///   Frame  bone frame unless stated.   Units  SI.   Errors  none.   Thread  any, once created.   Source  own derivation.
#pragma once

#include <optional>
#include <vector>

#include "app/view/view.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

class AssumedBrain {
 public:
  static constexpr double kThickest = 20e-3;  ///< [m] of bone at the entry that may be a skull
  /// Finds the inner surface of the bone along the approach axis, on a lattice across it. @param bone as drawn; one that is large at coarse
  /// voxels. @param edge [m] of the finest voxels that are drawn. @param thickness [m] of bone at the entry. @returns nothing for a bone
  /// that has soft tissue or labelled layers of its own, or is too thick for a skull.
  [[nodiscard]] static std::optional<AssumedBrain> create(const BoneModel& bone, const Pose& bone_from_approach, double thickness,
                                                          double edge);

  struct Sample {
    double soft = 0.0;  ///< [-] occupancy of dura and brain
    Vec3 normal{0.0};   ///< [-] outward, of their surface; zero far from it
    bool dura = false;
  };
  /// @param edge [m] of the voxels for which the surface is a ramp.
  [[nodiscard]] Sample at(const Vec3& p_bone, double edge) const;
  /// @returns the depth [m] of the inner surface below the entry, in the approach frame; nothing beside the bone.
  [[nodiscard]] std::optional<double> inner_depth(double x, double y) const;

  /// Adds them to all texels of a volume.
  void add_to(VolumeView& volume) const;
  /// Adds them to texels that have changed. @param bone_from_index of the volume that holds them.
  void add_to(TexelBox& texels, const Affine& bone_from_index) const;

 private:
  struct Column {
    double inner = 0.0, next = 0.0;  ///< [m] depths of the inner surface and of the bone beyond it
    bool found = false;
  };
  AssumedBrain(const Pose& bone_from_approach, double edge) : approach_from_bone_(bone_from_approach.inverse()), edge_(edge) {}
  [[nodiscard]] Column& column(int i, int j) { return columns_[static_cast<std::size_t>(j) * kColumns + static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Column& column(int i, int j) const {
    return columns_[static_cast<std::size_t>(j) * kColumns + static_cast<std::size_t>(i)];
  }
  /// Interpolates, by the columns that have bone. @param next receives the depth of the bone beyond.
  [[nodiscard]] std::optional<double> depth_at(double x, double y, double& next) const;
  void fill();
  void smooth();

  static constexpr std::size_t kColumns = 121;  // [-] along each side of the lattice
  Pose approach_from_bone_;
  double edge_;  // [m]
  std::vector<Column> columns_;
};

}  // namespace burrhole
