/// haptics/servo/chip_vibration.h: the vibration of a bit by the chips that its teeth cut.
///   Frame  that of the axis.   Units  SI.   Errors  out_of_range from create().   Thread  servo; fixed memory.
///   Model  A tooth cuts with the tangential force F. A chip of thickness h is sheared off steadily where it is thin and breaks where it is
///          thick, and the force on the tooth falls as it breaks: by the share h / (h + h_f). So the vibration has the size
///          a = F h / (h + h_f), which follows the chip load at the time constant T. Of z teeth one passes at z n, with n the spin: a force
///          of size a turns z times in a turn of the bit. Teeth do not cut alike: a force of size u a turns with the bit itself.
///   Band   Up to 0.4 of the rate of the ticks a turning force has its size, at half of that rate and above none, linear between. So of fast
///          bits only the slow part, the envelope of the tooth passing tone, is in the hand; [sound] has the tone.
///   Source own form. [facts] chips: bone shears at 10 to 50 um and fractures above 100 um (Luo 2022); h_f lies between.
#pragma once

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct ChipVibrationConfig {
  double fracture = 75e-6;  ///< [m] > 0: h_f (an assumption)
  double uneven = 0.2;      ///< [-] >= 0: u (an assumption)
  double rise = 0.02;       ///< [s] > 0: T, one bone step of the default rate (an assumption)
};

/// What the teeth cut.
struct ToothLoad {
  double force = 0.0;      ///< [N] F
  double thickness = 0.0;  ///< [m] h
  int teeth = 0;           ///< [-] z
};

class ChipVibration {
 public:
  static constexpr double kWhole = 0.4;  ///< [-] of the rate of the ticks, up to which a turning force has its whole size
  static constexpr double kNone = 0.5;   ///< [-] of it, from which it has none

  [[nodiscard]] static Result<ChipVibration> create(const ChipVibrationConfig& config);
  /// @param spin [rev/s] >= 0. @param axis unit, of the bit. @returns the force [N] of this tick of `dt` [s].
  [[nodiscard]] Vec3 operator()(const ToothLoad& load, double spin, const Vec3& axis, double dt) noexcept BH_REALTIME;
  void clear() noexcept { size_ = tooth_ = turn_ = 0.0; }
  [[nodiscard]] double size() const noexcept { return size_; }  ///< [N] a

 private:
  explicit ChipVibration(const ChipVibrationConfig& config) : config_(config) {}
  ChipVibrationConfig config_;
  double size_ = 0.0;                // [N]
  double tooth_ = 0.0, turn_ = 0.0;  // [-] phases, in [0, 1)
};

}  // namespace burrhole
