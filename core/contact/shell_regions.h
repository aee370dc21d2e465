/// core/contact/near_spots.h: selects the nearest hit of each region of a tool's surface, so that a few planes represent the possible next
///   contacts in all directions.
///   Frame  tool.   Units SI.   Thread contact; never allocates after construction.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/surface_probe.h"
#include "core/tool/tool.h"

namespace burrhole {

inline constexpr std::size_t kMaxSpots = 24;
inline constexpr std::uint32_t kNoHit = 0xffffffffu;

class NearSpots {
 public:
  /// Divides the shell into at most kMaxSpots regions of similar position and direction (farthest-point seeds, each point to the nearest
  /// seed).
  explicit NearSpots(const PointShell& shell);
  /// The index of the nearest hit of each region; kNoHit where a region has no hit.
  void pick(const ProbeHits& hits, std::array<std::uint32_t, kMaxSpots>& out) const noexcept;
  [[nodiscard]] std::size_t spot_of(std::size_t point) const noexcept { return spot_of_[point]; }

 private:
  std::vector<std::uint8_t> spot_of_;  // per shell point
};

}  // namespace burrhole
