/// core/drill/erosion.h: erosion points remove bone from the master window.
///   Units SI; remaining 0..1, float.   Thread simulation, the only writer of bone.
///   Source [AcostaLiu07] section 3, eq. 4 (`per-update`); the `rate` law is our own continuous form of it (see ErosionLaw).
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

enum class ErosionLaw {
  /// dr/dt = -(lambda / h) r on the remaining fraction r, h = max(hardness, 0.1), lambda [1/s] = spin [rev/s] x sum over the points in the
  /// voxel of e x (point pitch / voxel pitch)^3: the same bone goes whatever the rate and the pitch of the points.
  rate,
  /// Eq. 4 as printed: b' = b (1 - e s), once for each point in the voxel and update, without hardness; e s >= 1 gives 0.
  per_update,
};

struct ErosionConfig {
  ErosionLaw law = ErosionLaw::rate;
  float minimum_density = 0.05f;  ///< [0, 0.5): density below becomes 0 (the paper's minimum threshold)
  double longest_substep = 0.5;   ///< [voxels] of path between two applications, so that a fast hand skips no bone
};

/// What one step did.
struct ErosionOutcome {
  double removed_mass = 0.0;  ///< [m^3] integral of occupancy x (loss of remaining)
  std::uint32_t substeps = 0;
  std::uint32_t touched = 0;  ///< voxels whose remaining changed, counted once a sub-step
  std::uint32_t outside = 0;  ///< points that met the edge of the window: bone there is not eroded (0 in a sound run)
  VoxelBox changed;           ///< box of all voxels changed: the caller hands it to Voxmap::commit
};

/// The straight path of one step, tool poses in index coordinates of the bone: p_index = linear * p_tool + offset.
struct ErosionPath {
  Affine from;
  Affine to;
};

/// Applies a tool's erosion points. One instance per tool and window; scratch memory is kept between steps.
class Erosion {
 public:
  /// out_of_range when minimum_density or longest_substep is outside its range, or the tool's points are not finite.
  [[nodiscard]] static Result<Erosion> create(const ErosionConfig& config, const ErosionPoints& points);

  /// Erodes along the path for `dt` [s] at `spin` [rev/s] (>= 0; 0 removes nothing) ; the
  /// caller commits `changed`. For `per_update` each sub-step is one update.
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, double spin, double dt);

  [[nodiscard]] const ErosionConfig& config() const noexcept { return config_; }
  [[nodiscard]] int substeps_for(const ErosionPath& path) const noexcept;

 private:
  Erosion(const ErosionConfig& config, const ErosionPoints& points);
  void gather_exposure(const MasterWindow& window, const Affine& index_from_tool, ErosionOutcome& outcome);
  void apply_rate(Voxmap& voxmap, double rate_scale, double dt, ErosionOutcome& outcome);
  void apply_per_update(Voxmap& voxmap, const Affine& index_from_tool, double spin, ErosionOutcome& outcome);

  struct Run {
    Vec3 start;                  // [m] tool frame
    std::uint32_t first, count;  // into points_
  };
  ErosionConfig config_;
  ErosionPoints points_;
  std::vector<Run> runs_;
  Vec3 lo_{0.0}, hi_{0.0};              // bounds of the points, tool frame
  std::vector<float> exposure_;         // sum of e per voxel of the window; zero between sub-steps
  std::vector<std::uint32_t> touched_;  // voxels with exposure, in the order met
};

}  // namespace burrhole
