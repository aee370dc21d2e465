/// core/blood/blood_site.h: where a hole bleeds, and how much it holds: opened pores, the volume of the hole by height, its rim.
///   Model  The pores of spongy bone are 1 - (relative mineral density) of its volume, and the same share of each cut through it (Delesse). The area
///          of a cut is the integral of |gradient of density| (coarea formula), which does not count the steps of voxels as their faces would.
///          A source is a voxel in which, or beside which, bone was taken away; it is fresh whenever the surface in it changes.
///          A voxel is updated again only if its density or that of one of its six neighbours is new.
///          The hole is what was taken away of the bone as loaded. Its volume is kept by height over gravity, in layers of one voxel, so the level
///          of what it holds follows directly; it is one pool. It overflows where a voxel of it touches the outside. Below it is closed.
///   Frame  index coordinates; heights [m] are along the bone frame's direction against gravity.   Units  SI.
///   Errors  none.   Thread  one. Allocates in the constructor only.   Source  own derivation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// Bone near the hole. All vectors have box.count() values, i fastest.
struct SiteBone {
  VoxelBox box;
  Affine bone_from_index;               ///< [m]
  Vec3 down{0.0, 0.0, -1.0};            ///< [-] unit, bone frame: direction of gravity
  std::vector<float> whole{};           ///< [-] density as loaded
  std::vector<float> start{};           ///< [-] density before the run: cuts from before it do not bleed
  std::vector<float> pores{};           ///< [-] share of blood-filled pores, 0 in dense bone
  std::vector<std::uint8_t> outside{};  ///< 1: a place without bone into which the hole overflows
};

class BloodSite {
 public:
  /// @pre box is not empty, sizes agree, bone_from_index is regular.
  explicit BloodSite(SiteBone bone);

  /// Reads bone that changed. @param changed inside box(). @param density [-] over changed.grown(1), i fastest. @param now [s].
  /// @param coagulation [s] time constant with which sources decay.
  void update(const VoxelBox& changed, std::span<const float> density, double now, double coagulation) noexcept;
  /// Sources coagulate. @param factor [-] exp(-dt / time constant).
  void decay(double factor) noexcept;
  /// Closes all sources, and the pores of bone whose voxels lie within `depth` [m] of their face, where the density is one half. A cut is spread over
  /// two voxels on both sides of its face; that much is closed at least. @returns the area [m^2] of pores that it closed.
  double wax(double depth) noexcept;
  /// Removes all wax: the places bleed again, as far as they have not coagulated. @param now [s]. @param coagulation [s].
  void unwax(double now, double coagulation) noexcept;

  [[nodiscard]] const VoxelBox& box() const noexcept { return bone_.box; }
  [[nodiscard]] const SiteBone& bone() const noexcept { return bone_; }
  [[nodiscard]] bool has_pores() const noexcept { return has_pores_; }
  /// @returns the sum over the sources of pore area x share not yet coagulated x max(0, pressure - weight x (level - height)) [Pa m^2].
  /// @param level [m] of the liquid. @param weight [Pa/m] of it.
  [[nodiscard]] double drive(double pressure, double level, double weight) const noexcept;
  /// @returns the lowest height [m] of an open source; nothing without one.
  [[nodiscard]] std::optional<double> lowest_source() const noexcept;
  [[nodiscard]] double open_pores() const noexcept { return open_pores_; }    ///< [m^2] opened and not waxed, coagulated or not
  [[nodiscard]] double waxed_pores() const noexcept { return waxed_pores_; }  ///< [m^2] of the present surface
  [[nodiscard]] double cut_spongy() const noexcept { return cut_spongy_; }    ///< [m^2] present area of cut bone with pores

  [[nodiscard]] double capacity() const noexcept { return capacity_; }  ///< [m^3] below the rim
  [[nodiscard]] double spill() const noexcept { return spill_; }        ///< [m] height at which it overflows
  [[nodiscard]] double floor() const noexcept { return floor_; }        ///< [m] lowest height of the hole
  /// @returns the volume [m^3] of the hole below a height.
  [[nodiscard]] double volume_below(double height) const noexcept;
  /// @returns the height [m] to which a volume fills the hole, at most spill().
  [[nodiscard]] double level_of(double volume) const noexcept;
  /// @returns the area [m^2] of the hole at a height.
  [[nodiscard]] double area_at(double height) const noexcept;

  // Of each voxel, for pictures, in the order of SiteBone.
  [[nodiscard]] std::span<const float> pore_area() const noexcept { return area_; }           ///< [m^2] of a source; 0: none
  [[nodiscard]] std::span<const std::uint8_t> waxed() const noexcept { return waxed_; }       ///< 1: wax is in its pores
  [[nodiscard]] std::span<const std::uint16_t> removed() const noexcept { return removed_; }  ///< share of the voxel, of kWhole
  [[nodiscard]] double height_of(const Vec3& index) const noexcept { return glm::dot(up_index_, index) + up_offset_; }
  static constexpr std::uint16_t kWhole = 65535;
  [[nodiscard]] static std::size_t bytes_of(const VoxelBox& box) noexcept {
    return box.count() * (5 * sizeof(float) + sizeof(double) + 3 * sizeof(std::uint16_t) + 3) + box.grown(1).count() * sizeof(float);
  }

 private:
  /// A layer of the hole, one voxel high.
  struct Layer {
    std::int64_t removed = 0;  ///< [voxels / kWhole]
    std::int64_t rim = 0;      ///< voxels of the hole that touch the outside here
    std::int64_t sources = 0;  ///< open sources
    double pores = 0.0;        ///< [m^2] of the open sources, times the share that has not coagulated
  };
  /// Marks the voxels for which a density of `of` is new.
  void note_changes(const VoxelBox& of, std::span<const float> density) noexcept;
  void set_removed(std::size_t at, float density) noexcept;
  void set_source(std::size_t at, double area, double now, double coagulation) noexcept;
  /// @returns the share of a source that has not coagulated. @param age [-] over the time constant.
  [[nodiscard]] double left_after(double age) noexcept;
  /// Wax in the pores within `depth` [m] of the face of a source.
  void fill_pores(const Vec3i& source, double depth) noexcept;
  [[nodiscard]] double cut_area(const VoxelBox& of, std::span<const float> density, const Vec3i& voxel) const noexcept;
  [[nodiscard]] bool was_cut(const VoxelBox& of, std::span<const float> density, const Vec3i& voxel) const noexcept;
  void measure() noexcept;
  [[nodiscard]] double bottom_of(std::size_t layer) const noexcept { return lowest_ + height_ * static_cast<double>(layer); }

  SiteBone bone_;
  Mat3 bone_from_slope_;  // [1/m] from a gradient over index coordinates
  double cell_ = 0.0;     // [m^3]
  Vec3 up_index_;         // [m] height of a step of each index
  double up_offset_ = 0.0, lowest_ = 0.0, height_ = 0.0;
  std::vector<Layer> layers_;
  std::vector<std::uint16_t> layer_, rim_;  // of each voxel; of its lowest way to the outside, or kNone
  std::vector<std::uint16_t> removed_;
  std::vector<float> area_;     // [m^2]
  std::vector<double> opened_;  // [s] when its surface last changed
  std::vector<float> cut_;      // [m^2] area of the cut, pores or not
  std::vector<std::uint8_t> waxed_;
  std::vector<float> seen_;             // [-] density of the last update, over the box grown by 1; NaN: none yet
  std::vector<std::uint8_t> is_new_;    // the voxel, or a neighbour, has another density than when the voxel was updated
  double last_age_ = 0.0, left_ = 1.0;  // of left_after(): most sources of a step are of one age
  bool has_pores_ = false;
  double open_pores_ = 0.0, waxed_pores_ = 0.0, cut_spongy_ = 0.0;
  double capacity_ = 0.0, spill_ = 0.0, floor_ = 0.0;
};

}  // namespace burrhole
