/// core/contact/near_spots.h: which of many near points of a tool stand for all: the nearest of each spot of its surface, so that a handful
/// of planes tells what the tool will meet next whichever way it goes.
///   Frame  tool.   Units SI.   Thread contact; never allocates after its construction.
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
  /// Parts the shell into at most kMaxSpots spots of alike place and direction (farthest points first, each point to the nearest).
  explicit NearSpots(const PointShell& shell);
  /// The nearest hit of each spot, by index into the hits; kNoHit where a spot has none.
  void pick(const ProbeHits& hits, std::array<std::uint32_t, kMaxSpots>& out) const noexcept;
  [[nodiscard]] std::size_t spot_of(std::size_t point) const noexcept { return spot_of_[point]; }

 private:
  std::vector<std::uint8_t> spot_of_;  // a shell point
};

}  // namespace burrhole
