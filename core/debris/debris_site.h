/// core/debris/debris_site.h: the place where chips fly and settle: what is solid there, and how full of chips it is.
///   Solid   bone whose density, trilinear between voxels, is at least 0.5; dura and brain by whole voxels; and a heap cell that is full.
///   Heap    cubes of one edge. A cell is full when the chips that lie in it, with the gaps between them, have its volume.
///   Frame   bone; voxels in index coordinates.   Units  SI; densities 0..1, kept to 1/254.   Errors  out_of_range from create().
///   Thread  one.   Source  own derivation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

/// A voxel from which bone was removed, and what was left in it: if it has more later, bone was brought back.
struct DebrisBirth {
  Vec3i voxel{0};         ///< [voxels]
  std::uint8_t left = 0;  ///< [1/254]
};

/// Takes samples of what set_bone() finds removed, each voxel with a chance in proportion to its loss.
class LossSampler {
 public:
  static constexpr std::size_t kMost = 16;
  /// @param total [1/254 voxel] that will be removed. @param phase [-] in [0, 1): of the first sample.
  LossSampler(double total, double phase) : spacing_(total / static_cast<double>(kMost)), next_(phase * spacing_) {}
  void add(const Vec3i& voxel, int loss, std::uint8_t left) noexcept {
    passed_ += static_cast<double>(loss);
    for (; next_ < passed_ && count_ < kMost; next_ += spacing_) births_[count_++] = {voxel, left};
  }
  [[nodiscard]] std::span<const DebrisBirth> births() const noexcept { return {births_, count_}; }

 private:
  double spacing_, next_, passed_ = 0.0;
  std::size_t count_ = 0;
  DebrisBirth births_[kMost];
};

class DebrisSite {
 public:
  /// @param box [m] in which chips are followed. @param grid voxels of the bone; only those inside the box are kept. @param cell [m] edge of a
  /// heap cell. @param down unit, bone frame. out_of_range: the box has no size, or more than kMostCells cells.
  static constexpr std::size_t kMostCells = 20'000'000;
  [[nodiscard]] static Result<DebrisSite> create(const Bounds& box, const Affine& bone_from_index, const VoxelBox& grid, double cell,
                                                 const Vec3& down);
  /// @returns the voxels of the grid that a box holds.
  [[nodiscard]] static VoxelBox voxels_in(const Bounds& box, const Affine& bone_from_index, const VoxelBox& grid) noexcept;

  [[nodiscard]] const VoxelBox& voxels() const noexcept { return voxels_; }
  [[nodiscard]] const Bounds& box() const noexcept { return box_; }
  [[nodiscard]] double cell() const noexcept { return cell_; }
  [[nodiscard]] double cell_volume() const noexcept { return cell_ * cell_ * cell_; }
  [[nodiscard]] double voxel() const noexcept { return shortest_; }  ///< [m] shortest edge of a voxel
  [[nodiscard]] const Vec3& down() const noexcept { return down_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return solid_.size() + fill_.size() * sizeof(float); }

  /// Marks voxels as soft tissue, which stays: part is clipped to voxels(). @param soft over `part`, not 0: soft.
  void set_floor(const VoxelBox& part, std::span<const std::uint8_t> soft) noexcept;
  /// @returns the bone [1/254 voxel] that set_bone() of the same would remove. @param part inside voxels(). @param density over it, i fastest.
  [[nodiscard]] double loss_of(const VoxelBox& part, std::span<const float> density) const noexcept;
  /// @param sampler null: none.
  void set_bone(const VoxelBox& part, std::span<const float> density, LossSampler* sampler = nullptr) noexcept;
  /// @returns the box [m] outside which level() is as it was at the last call, at the first as in an empty site; nothing: everywhere.
  [[nodiscard]] std::optional<Bounds> take_changed() noexcept;
  /// @returns the bone of a voxel [1/254]; 0 outside and in soft tissue.
  [[nodiscard]] std::uint8_t bone_at(const Vec3i& voxel) const noexcept;

  [[nodiscard]] Vec3 place_of(const Vec3i& voxel) const noexcept { return bone_from_index_ * Vec3(voxel); }
  [[nodiscard]] bool contains(const Vec3& p) const noexcept {
    return p.x > box_.lo.x && p.y > box_.lo.y && p.z > box_.lo.z && p.x < box_.hi.x && p.y < box_.hi.y && p.z < box_.hi.z;
  }
  /// @returns the trilinear share of what is solid, without chips.
  [[nodiscard]] double level(const Vec3& p) const noexcept;
  [[nodiscard]] bool is_solid(const Vec3& p) const noexcept { return level(p) >= 0.5; }
  [[nodiscard]] bool is_blocked(const Vec3& p) const noexcept { return is_full(cell_of(p)) || is_solid(p); }
  /// @returns the free share, 0..1, of the way from a place to another: 1 if nothing blocks it, 0 if the start is blocked. Places half a voxel
  /// apart are tested, up to the edge of the site, and the last part is halved, so the end lies within 1/16 of a voxel before what blocks it.
  [[nodiscard]] double free_share(const Vec3& from, const Vec3& to) const noexcept;
  /// @returns the place within a voxel below a chip where something carries it.
  [[nodiscard]] Vec3 below(const Vec3& p) const noexcept { return p + down_ * shortest_; }
  /// @returns whether something other than chips of its own cell carries a chip.
  [[nodiscard]] bool is_carried(const Vec3& p) const noexcept { return is_solid(below(p)) || is_heaped({cell_of(p), cell_of(below(p))}); }
  /// The cells of a chip and of the place below it.
  struct CellPair {
    std::size_t own, below;
  };
  /// @returns whether chips of another cell carry a chip.
  [[nodiscard]] bool is_heaped(const CellPair& cells) const noexcept { return cells.below != cells.own && is_full(cells.below); }
  /// @returns the centre of an open neighbour of the cell of p that is lower by at least half a cell, the lowest; a chip slides there. @param salt
  /// chooses among neighbours of one height.
  [[nodiscard]] std::optional<Vec3> slide_from(const Vec3& p, std::uint64_t salt) const noexcept;

  /// Nothing slides into the bit: a cylinder without end from its tip up. @param radius [m] 0: no bit.
  void set_bit(const Vec3& tip, const Vec3& axis, double radius) noexcept {
    bit_tip_ = tip;
    bit_axis_ = axis;
    bit_radius2_ = radius * radius;
  }

  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
  [[nodiscard]] std::size_t cells() const noexcept { return fill_.size(); }
  [[nodiscard]] std::size_t cell_of(const Vec3& p) const noexcept;  ///< kNowhere outside
  [[nodiscard]] bool is_full(std::size_t cell) const noexcept { return cell != kNowhere && fill_[cell] >= capacity_; }
  /// Adds chips with their gaps to the cell of p; what is more than a cell holds goes to the cells above it, up to kMostPiled. @param volume [m^3].
  void pile(const Vec3& p, double volume) noexcept { pile(p, cell_of(p), volume); }
  /// @param cell that of p, as in the next.
  void pile(const Vec3& p, std::size_t cell, double volume) noexcept { change_pile(p, cell, volume, 1.0f); }
  void take_off(const Vec3& p, double volume) noexcept { change_pile(p, cell_of(p), volume, -1.0f); }  ///< the reverse
  /// Empties the cells that pile() of the same changes.
  void clear_pile(const Vec3& p, std::size_t cell, double volume) noexcept { change_pile(p, cell, volume, 0.0f); }
  static constexpr int kMostPiled = 64;

 private:
  static constexpr std::uint8_t kSoft = 255;
  static constexpr float kWhole = 254.0f;
  DebrisSite() = default;
  [[nodiscard]] double value(const Vec3i& voxel) const noexcept {
    return voxels_.contains(voxel) ? static_cast<double>(solid_[voxels_.offset_of(voxel)]) : 0.0;
  }
  [[nodiscard]] Vec3i cell_place(const Vec3& p) const noexcept { return floor_int((p - box_.lo) * per_cell_); }
  [[nodiscard]] bool is_in_bit(const Vec3& p) const noexcept {
    const Vec3 from_tip = p - bit_tip_;
    const double along = glm::dot(from_tip, bit_axis_);
    return along > 0.0 && glm::dot(from_tip, from_tip) - along * along < bit_radius2_;
  }
  void change_pile(const Vec3& p, std::size_t cell, double volume, float sign) noexcept;
  /// Calls f(the first voxel of a row of `part`, its solid bytes, its densities).
  template <class Solid, class F>
  void for_each_row(const VoxelBox& part, Solid* solid, std::span<const float> density, const F& f) const noexcept {
    const auto length = static_cast<std::size_t>(part.hi.x - part.lo.x);
    for (int k = part.lo.z; k < part.hi.z; ++k)
      for (int j = part.lo.y; j < part.hi.y; ++j) {
        const Vec3i first(part.lo.x, j, k);
        f(first, std::span(solid + voxels_.offset_of(first), length), density.subspan(part.offset_of(first), length));
      }
  }

  Bounds box_;
  Affine bone_from_index_, index_from_bone_;
  VoxelBox voxels_, cell_box_, changed_;
  double cell_ = 0.0, per_cell_ = 0.0, shortest_ = 0.0;
  float capacity_ = 0.0f;  // [m^3] of a cell
  Vec3 down_{0.0, 0.0, -1.0};
  Vec3 bit_tip_{0.0}, bit_axis_{0.0, 0.0, 1.0};
  double bit_radius2_ = 0.0;         // [m^2]
  std::vector<std::uint8_t> solid_;  // bone in 1/254; kSoft
  std::vector<float> fill_;          // [m^3]
};

}  // namespace burrhole
