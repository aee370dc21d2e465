/// haptics/device/device_model.h: parameters of force devices and of hands that hold them, each with its source.
///   Units  SI.   Errors  bad_input for an unknown name.   Thread  any: constant tables.
///   Source "CHAI3D 3.3.0": specifications in its device classes, which are safety limits of a library, not measured stability limits;
///          "vendor sheet": recalled, not verified. A value without a source is the assumed value of the generic test device, marked
///   `assumed`.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/result.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

enum class Provenance : std::uint8_t {
  read,        ///< in the named source
  derived,     ///< computed from values of the named source
  unverified,  ///< recalled from the named source, to be verified before publication
  assumed,     ///< chosen for tests, not a measurement
  absent,      ///< no such value; 0
};
/// @returns the name of a provenance: "read", "derived", ...
[[nodiscard]] std::string_view name_of(Provenance provenance) noexcept;

struct Figure {
  double value = 0.0;  ///< [unit of the member that holds the figure]
  Provenance provenance = Provenance::absent;
  std::string_view source;
};

struct DeviceModel {
  std::string_view name;  ///< name in scenes: "falcon"
  std::string_view title;
  Figure largest_force;      ///< [N]
  Figure library_stiffness;  ///< [N/m] limit of the library for a virtual wall; absent if no library states one
  Figure library_damping;    ///< [N s/m] limit of the library for the damping of a virtual wall
  Figure workspace_radius;   ///< [m]
  Figure friction;           ///< [N] Coulomb
  Figure mass;               ///< [kg] apparent mass at the grip
  Figure damping;            ///< [N s/m] viscous
  Figure quantum;            ///< [m] smallest difference between two reported positions
};

/// A figure of a device and the name under which tables print it.
struct DeviceFigureName {
  std::string_view name;
  std::string_view unit;
  Figure DeviceModel::*figure;
};
[[nodiscard]] std::span<const DeviceFigureName> device_figure_names() noexcept;

/// A hand as mass, damper and spring at the grip of the device.
struct HandModel {
  std::string_view name;  ///< name in scenes: "nominal"
  std::string_view title;
  Figure mass;       ///< [kg]
  Figure damping;    ///< [N s/m]
  Figure stiffness;  ///< [N/m]
};

[[nodiscard]] std::span<const DeviceModel> device_models() noexcept;
[[nodiscard]] std::span<const HandModel> hand_models() noexcept;
/// @returns the model by name; bad_input otherwise, with the nearest name if there is one.
[[nodiscard]] Result<const DeviceModel*> find_device(std::string_view name);
[[nodiscard]] Result<const HandModel*> find_hand(std::string_view name);

/// @returns device and hand as one body: masses and dampings add, the spring is that of the hand.
[[nodiscard]] MassSpringDamperConfig body_of(const DeviceModel& device, const HandModel& hand) noexcept;

}  // namespace burrhole
