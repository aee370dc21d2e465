/// core/drill/coverage.h: the part of each voxel that a tool has covered so far. It bounds the bone that the tool may remove.
///   Frame   index coordinates of the bone.   Units  [voxels] unless stated.   Errors  none.   Thread  simulation.
///   Source  own derivation:
///   Each voxel has N sample points (coverage_samples.h; 64, or 256 for a slim tool). A mask marks the samples that the cutting part of the
///   tool has met, including those on the straight line between two poses. The mask is the union over all sub-steps and steps. The covered
///   share c = marks / N of the voxel may be removed, so remaining r >= 1 - c and r = (1 - c) + m, with m the covered mass that is left.
///   When c grows by dc, m grows by dc. A law then removes m at the rate lambda' = e spin (share under the tool now) / c: the full rate in
///   a voxel that is covered and under the tool. m is not stored, since m = r - (1 - c).
///   The share under the tool now affects the speed only. It is a ramp of the distance d from the voxel's centre to the tool at the middle
///   of the sub-step, 1/2 - d / (2 w), w = sqrt(3 variance) of the kernel: exact on average when a plane passes. A sample first met in this
///   sub-step is taken as met half-way through it, which is the average.
///   Masks are stored in blocks of 8^3 voxels wherever the tool has been, also outside the window, so that the window can slide. A block
///   that is covered completely stores no masks.
///   A voxel is inactive, its mask not read, until the tool may have come as near as the nearest unmet sample, that is, while the travel of
///   all steps since, times the largest slope of interpolated distances, is below the distance of that sample. The travel is bounded by
///   the corners of a box around the tool. The masks are the same as without inactive voxels. A block that the tool has left and re-entered
///   is evaluated again.
///   When bone grows back (restore), all masks are dropped. A voxel without a mask is assumed to have lost c = 1 - r on the side towards
///   which remaining decreases (a plane across the voxel). This is exact where covered bone is gone, as behind a tool that cuts at full
///   rate. A voxel that was covered completely and had mass left is covered again, with the same mass, when the tool returns.
#pragma once

#include <array>
#include <bitset>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/drill/coverage_samples.h"
#include "core/tool/cutting_field.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// A voxel that the tool acts on in one sub-step.
struct Engaged {
  std::uint32_t at;  ///< offset into the window
  float available;   ///< [-] part of remaining that may be removed
  float share;       ///< [-] share of the voxel that is covered, (0, 1]
  float exposure;    ///< [1/rev] e x share of the covered part under the tool; lambda of law `rate` is spin x exposure
  float radius;      ///< [m] from the tool's axis
};

struct CoverageSweep;
struct MeetJob;

class Coverage {
 public:
  /// @pre `field` is not null.
  Coverage(std::shared_ptr<const CuttingField> field, CoverageKernel kernel);

  /// Marks the samples that the tool covers from `path.from` to `path.to`, and appends the voxels with bone that may be removed, ordered k,
  /// j, i.
  /// @returns the number of voxels that the tool reaches outside the erodible box.
  std::uint32_t advance(const Voxmap& voxmap, const ErosionPath& path, std::vector<Engaged>& engaged);

  /// @returns the share of a voxel [-] covered so far, 0..1; 0 if unknown.
  [[nodiscard]] double covered(const Vec3i& voxel) const;
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr int kEdge = 8;
  static constexpr std::size_t kBlockVoxels = 512;
  struct Block {
    explicit Block(std::size_t words) : masks(words * kBlockVoxels) {}
    std::vector<std::uint64_t> masks;             ///< `words` per voxel
    std::array<double, kBlockVoxels> inactive{};  ///< [m] no further sample is met until odometer_ exceeds this
    std::bitset<kBlockVoxels> known{};
    std::size_t full = 0;    ///< voxels with all samples met
    std::uint64_t seen = 0;  ///< number of the sub-step that evaluated the block last
  };
  struct Near;
  struct Probe;
  [[nodiscard]] static std::uint64_t key_of(const Vec3i& block) noexcept;
  void start_step(const ErosionPath& path, const CoverageSweep& sweep);
  void visit_block(const Voxmap& voxmap, const CoverageSweep& sweep, const Vec3i& block, std::vector<Engaged>& engaged);
  void find_near(const MasterWindow& window, const CoverageSweep& sweep, const Vec3i& block, Near& near) const;
  void mark(const MasterWindow& window, const CoverageSweep& sweep, const Vec3i& corner, Block& block, Near& near);
  void weigh(const CoverageSweep& sweep, Near& near, std::vector<Engaged>& engaged) const;
  void mark_from_remaining(const MasterWindow& window, const Vec3i& voxel, float remaining, std::uint64_t* mask) const;
  [[nodiscard]] float meet(const CoverageSweep& sweep, const Probe& probe, std::uint64_t* mask) const;
  [[nodiscard]] bool meet_alone(const CoverageSweep& sweep, const Probe& probe, const MeetJob& job, const Vec3f& offset) const;
  [[nodiscard]] int marks_in(const std::uint64_t* mask) const noexcept;
  [[nodiscard]] float share_of(int marks) const noexcept;

  std::shared_ptr<const CuttingField> field_;
  CoverageKernel kernel_;
  CoverageSamples samples_;  // chosen at the first step, when the voxel size is known
  double steepest_ = 1.0;    // [-] largest slope of interpolated distances
  /// Curvature of the field at a node [1/m].
  struct Bend {
    float down;  ///< [1/m] largest downwards within the margin of the node; 0 for convex tools
    float up;    ///< [1/m] largest upwards at the node and its neighbours
  };
  std::vector<Bend> bends_;                                           // per node
  std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;  // null: covered completely
  std::uint64_t growth_epoch_ = 0;
  std::uint64_t step_ = 0;      // number of the current sub-step; 0 before the first
  Affine last_{};               // pose at the end of the last sub-step
  double odometer_ = 0.0;       // [m] bound on the travel of any point near the tool, to the end of the last sub-step
  double half_odometer_ = 0.0;  // [m] the same, to the middle of the current sub-step
};

}  // namespace burrhole
