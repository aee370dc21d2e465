/// haptics/hand/hand_switches.h: the bits of HandState::switches. Bits 0 to 2 are buttons and pedals of a device; BoneSwitch (bone_drive.h) has
/// bits 3 to 15; bits 16 to 18 are instruments that an assistant holds beside the drill.
#pragma once

#include <cstdint>

namespace burrhole {

/// An instrument is on while its bit is set. Wax is applied when its bit is set.
enum InstrumentSwitch : std::uint32_t { kSuctionSwitch = 1u << 16, kWaxSwitch = 1u << 17, kIrrigationSwitch = 1u << 18 };
inline constexpr std::uint32_t kAllSwitches = (1u << 19) - 1;

}  // namespace burrhole
