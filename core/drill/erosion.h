/// core/drill/erosion.h: erosion points remove bone from the master window.
///   Units SI; remaining 0..1, float.   Thread simulation, the only writer of bone.
///   Source [AcostaLiu07] section 3, eq. 4 (`per-update`); the `rate` law is our own continuous form of it (see ErosionLaw).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/drill/exposure.h"
#include "core/drill/strength_field.h"
#include "core/tool/tool.h"
#include "core/voxel/box_set.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

enum class ErosionLaw {
  /// dr/dt = -(lambda / h) r on the remaining fraction r, h = max(hardness, 0.1), lambda [1/s] = spin [rev/s] x sum over the points in the
  /// voxel of e x (point pitch / voxel pitch)^3: the same bone goes whatever the rate and the pitch of the points.
  rate,
  /// Eq. 4 as printed: b' = b (1 - e s), once for each point in the voxel and update, without hardness; e s >= 1 gives 0. The product over
  /// the points of a voxel is taken as exp(sum of ln(1 - e s)), which differs from it by double rounding.
  per_update,
  /// Cutting power: the work mu F v_rel dt of a step is spent on the voxels engaged, at u0 h for a volume of bone: Q = mu F v_rel / (u0 h).
  energy,
};

/// What the law `energy` asks of bone and tool.
struct EnergyConfig {
  double specific_energy = 1e8;  ///< [J/m^3] > 0: u0, at hardness 1; cortical bone: of the order of 0.1 J/mm^3 (not verified)
  double cutting_ratio = 0.5;    ///< [-] > 0: mu, cutting force over normal force (an assumption)
};

/// How wide a voxel looks for the tool's surface; see core/drill/coverage.h.
enum class CoverageKernel : std::uint8_t { cell, trapezoid, wide };

/// How points find the voxels that they expose.
enum class ErosionForm {
  scatter,  ///< each point is counted in the voxel that holds it: exact
  gather,   ///< each voxel looks the tool's strength up (strength_field.h): an approximation whose cost no number of points raises
};

struct ErosionConfig {
  ErosionLaw law = ErosionLaw::rate;
  ErosionForm form = ErosionForm::scatter;
  float minimum_density = 0.05f;  ///< [0, 0.5): density below becomes 0 (the paper's minimum threshold)
  double longest_substep = 0.5;   ///< [voxels] of path between two applications, so that a fast hand skips no bone
  bool subvoxel = false;          ///< laws `rate` and `energy`: the share of a voxel that the tool has covered bounds what may go
  CoverageKernel kernel = CoverageKernel::trapezoid;
  float clear_below = 0.0f;  ///< [0, 0.5] subvoxel: part of its covered share below which a voxel covered in part is cleared
  EnergyConfig energy{};
};

/// What one step did.
struct ErosionOutcome {
  double removed_mass = 0.0;  ///< [m^3] integral of occupancy x (loss of remaining)
  std::uint32_t substeps = 0;
  std::uint32_t touched = 0;    ///< voxels whose remaining changed, counted once a sub-step
  std::uint32_t outside = 0;    ///< points (sub-voxel: voxels) beyond the window's edge: bone there is not eroded (0 in a sound run)
  double energy = 0.0;          ///< [J] law `energy`: work done on bone, at most what the load brings
  double rubbing_radius = 0.0;  ///< [m] laws with a list of engaged voxels: radius at which they rub, by exposure; 0 when none is engaged
  BoxSet changed;               ///< disjoint boxes of all voxels changed: the caller hands them to Voxmap::commit
};

/// The straight path of one step, tool poses in index coordinates of the bone: p_index = linear * p_tool + offset.
struct ErosionPath {
  Affine from;
  Affine to;
};

/// What drives the tool.
struct CuttingLoad {
  double spin = 0.0;   ///< [rev/s] 0 removes nothing
  double force = 0.0;  ///< [N] normal force on the cutting part; law `energy` alone reads it: 0 removes nothing
};

class Coverage;
class EngagedRemoval;
struct CuttingField;

/// Applies a tool's erosion points. One instance per tool and window; scratch memory is kept between steps.
class Erosion {
 public:
  /// out_of_range when minimum_density or longest_substep is outside its range, or the tool's points are not finite.
  /// @param field the tool's cutting part, Tool::cutting; `subvoxel` needs it and no other mode reads it.
  [[nodiscard]] static Result<Erosion> create(const ErosionConfig& config, const ErosionPoints& points,
                                              std::shared_ptr<const CuttingField> field = nullptr);
  Erosion(Erosion&&) noexcept;
  Erosion& operator=(Erosion&&) noexcept;
  ~Erosion();

  /// Erodes along the path for `dt` [s] at `spin` [rev/s] (>= 0; 0 removes nothing) ; the
  /// caller commits `changed`. For `per_update` each sub-step is one update.
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, double spin, double dt);
  /// The same with a force, for law `energy`.
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, const CuttingLoad& load, double dt);

  [[nodiscard]] const ErosionConfig& config() const noexcept { return config_; }
  [[nodiscard]] int substeps_for(const ErosionPath& path) const noexcept;
  /// Null without `subvoxel`.
  [[nodiscard]] const Coverage* coverage() const noexcept;

 private:
  Erosion(const ErosionConfig& config, const ErosionPoints& points);
  void weigh_points(double spin, double voxel_edge);
  std::uint32_t expose(const MasterWindow& window, const Affine& index_from_tool);

  ErosionConfig config_;
  ErosionPoints points_;
  PointScatter scatter_;
  StrengthField strength_;                   // of form gather, made at the first step
  Vec3 lo_{0.0}, hi_{0.0};                   // bounds of the points, tool frame
  double weighed_for_ = 0.0;                 // [1] s of eq. 4 that the points' weights hold for; 0 when they are the factors
  ExposureField exposure_;                   // zero between sub-steps
  TileMarks marks_;                          // of voxels changed in the step at hand
  std::unique_ptr<EngagedRemoval> engaged_;  // law `energy` and sub-voxel removal; null otherwise
};

}  // namespace burrhole
