/// haptics/device/device_model.h: what is known of force devices and of the hands that hold them, each figure with where it comes from.
///   Units SI.   Thread any: constant tables.
///   Source "CHAI3D 3.3.0": its device classes' specifications, which are safety limits of a library and not measured frontiers; "vendor
///          sheet": recalled, not read again. What nobody tells takes the assumed figure of the generic test device, and says so.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/result.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

enum class Provenance : std::uint8_t {
  read,        ///< in the source named
  derived,     ///< computed from figures of the source named
  unverified,  ///< recalled from the source named, to be confirmed before it is published
  assumed,     ///< chosen for tests, not a measurement
  absent,      ///< there is no such figure; the value is 0
};
/// "read", "derived", ...
[[nodiscard]] std::string_view name_of(Provenance provenance) noexcept;

struct Figure {
  double value = 0.0;
  Provenance provenance = Provenance::absent;
  std::string_view source;
};

struct DeviceModel {
  std::string_view name;  ///< as in scenes: "falcon"
  std::string_view title;
  Figure largest_force;      ///< [N]
  Figure library_stiffness;  ///< [N/m] the library's limit for a wall; absent where no library names one
  Figure library_damping;    ///< [N s/m] the same for a wall's damping
  Figure workspace_radius;   ///< [m]
  Figure friction;           ///< [N] Coulomb
  Figure mass;               ///< [kg] as felt at the grip
  Figure damping;            ///< [N s/m] viscous
  Figure quantum;            ///< [m] step between two positions that it can tell
};

/// A figure of a device under the name that tables print.
struct DeviceFigureName {
  std::string_view name;
  std::string_view unit;
  Figure DeviceModel::*figure;
};
[[nodiscard]] std::span<const DeviceFigureName> device_figure_names() noexcept;

/// A hand as mass, damper and spring on the device's grip.
struct HandModel {
  std::string_view name;  ///< as in scenes: "nominal"
  std::string_view title;
  Figure mass;       ///< [kg]
  Figure damping;    ///< [N s/m]
  Figure stiffness;  ///< [N/m]
};

[[nodiscard]] std::span<const DeviceModel> device_models() noexcept;
[[nodiscard]] std::span<const HandModel> hand_models() noexcept;
/// bad_input with the nearest name where there is one.
[[nodiscard]] Result<const DeviceModel*> find_device(std::string_view name);
[[nodiscard]] Result<const HandModel*> find_hand(std::string_view name);

/// Device and hand as one body: masses and dampings add, the spring is the hand's.
[[nodiscard]] MassSpringDamperConfig body_of(const DeviceModel& device, const HandModel& hand) noexcept;

}  // namespace burrhole
