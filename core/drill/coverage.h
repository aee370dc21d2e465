/// core/drill/coverage.h: which part of each voxel a tool has covered so far: the bound on what it may remove.
///   Frame   index coordinates of the bone.   Thread  simulation.   Source  own derivation:
///   Of the voxel's N samples (coverage_samples.h; 64, of a slim tool 256) a mask marks those that the tool's cutting part has met on its
///   way, the straight line between two poses included: the union over sub-steps and steps. A share c = marks / N of the voxel may go, so
///   remaining r >= 1 - c, and
///   r = (1 - c) + m with m the covered mass left. When c grows by dc, so does m; then a law takes m at the rate
///   lambda' = e spin (share under the tool now) / c, full rate in a voxel that is covered and under the tool. m is not stored: it is
///   r - (1 - c). The share now, a matter of speed only, is a ramp of the distance d from the voxel's centre to the tool in the middle of
///   the sub-step, 1/2 - d / (2 w), w = sqrt(3 variance) of the kernel: exact on average over a plane's passage. What was met for the first
///   time in this sub-step was met half-way through it, on average.
///   Masks are kept by blocks of 8^3 voxels wherever the tool has been, outside the window too, so that a window may slide. A block that is
///   covered wholly keeps none.
///   A voxel sleeps, its mask unread, until the tool may have come as near as the nearest sample not yet met: the way of all steps since,
///   bounded by the corners of a box round the tool, times the steepest that interpolated distances get, is below that sample's distance.
///   So masks are the same as without sleep. A block that the tool has left in between is looked at anew.
///   When bone grows back (restore) all masks are dropped. A voxel met without a mask is taken to have lost c = 1 - r, on the side to
///   which remaining falls (a plane across it): exact where the covered bone is gone, as it is behind a tool that cuts at full rate; a
///   voxel that was covered wholly and had mass left is covered anew the moment the tool comes back, with the same mass.
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

/// A voxel that the tool works on in one sub-step.
struct Engaged {
  std::uint32_t at;  ///< into the window
  float available;   ///< part of remaining that may go
  float share;       ///< of the voxel that is covered, (0, 1]
  float exposure;    ///< [1/rev] e x share of the covered part under the tool: the rate law's lambda is spin x this
  float radius;      ///< [m] from the tool's axis
};

struct CoverageSweep;
struct MeetJob;

class Coverage {
 public:
  /// @pre the field is not null.
  Coverage(std::shared_ptr<const CuttingField> field, CoverageKernel kernel);

  /// Marks what the tool covers on its way from `path.from` to `path.to`, and appends the voxels with bone to take, k, j, i.
  /// @returns voxels that the tool reaches beyond the erodible box.
  std::uint32_t advance(const Voxmap& voxmap, const ErosionPath& path, std::vector<Engaged>& engaged);

  /// Share covered so far, 0..1; 0 where nothing is known.
  [[nodiscard]] double covered(const Vec3i& voxel) const;
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr int kEdge = 8;
  static constexpr std::size_t kBlockVoxels = 512;
  struct Block {
    explicit Block(std::size_t words) : masks(words * kBlockVoxels) {}
    std::vector<std::uint64_t> masks;           ///< words a voxel
    std::array<double, kBlockVoxels> asleep{};  ///< [m] up to this reading of odometer_ no sample more is met
    std::bitset<kBlockVoxels> known{};
    std::size_t full = 0;    ///< voxels with all samples met
    std::uint64_t seen = 0;  ///< number of the sub-step that looked at it last
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
  CoverageSamples samples_;  // chosen at the first step, when the voxels' size is known
  double steepest_ = 1.0;    // [-] of interpolated distances
  /// How far the field bends at a node [1/m].
  struct Bend {
    float down;  ///< anywhere within its margin; 0 for convex tools
    float up;    ///< at the node and its neighbours
  };
  std::vector<Bend> bends_;                                           // per node
  std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;  // null: covered wholly
  std::uint64_t growth_epoch_ = 0;
  std::uint64_t step_ = 0;      // number of the sub-step at hand; 0 before the first
  Affine last_{};               // pose at its end
  double odometer_ = 0.0;       // [m] bound on the way of any place near the tool, up to its end
  double half_odometer_ = 0.0;  // up to its middle
};

}  // namespace burrhole
