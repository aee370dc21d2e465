/// haptics/device/device_config.h: a simulated force device between hand and drill, as a scene asks for it. Units SI.
#pragma once

#include <optional>
#include <string>

#include "haptics/device/simulated_device.h"

namespace burrhole {

struct DeviceConfig {
  SimulatedDeviceConfig config;
  std::string hand = "nominal";       ///< who holds it: a name of find_hand()
  std::optional<double> force_scale;  ///< [-] force at the grip over force in the world; nothing: the script's push is all that it shows
  double position_scale = 1.0;        ///< [-] metres in the world for one of the grip
};

}  // namespace burrhole
