/// core/contact/shell_regions.h: divides a tool's point shell into regions and selects, in each, the shell point that is nearest to bone, so
///   that a few tangent planes cover the possible next contacts in all directions.
///   Frame  tool.   Units SI.   Errors  none.   Thread contact; never allocates after construction.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/surface_probe.h"
#include "core/tool/tool.h"

namespace burrhole {

inline constexpr std::size_t kMaxRegions = 24;
inline constexpr std::uint32_t kNoHit = 0xffffffffu;

class ShellRegions {
 public:
  /// At most kMaxRegions regions: seeds by farthest-point sampling, each point joins the nearest seed. Squared distance of two points:
  /// |dp|^2 / R^2 + |dn|^2, with positions p, inward normals n, and R half the diagonal of the shell's bounding box.
  explicit ShellRegions(const PointShell& shell);
  /// out[r]: index into `hits` of the hit of region r with the smallest surface distance; kNoHit if the region has none.
  void pick(const ProbeHits& hits, std::array<std::uint32_t, kMaxRegions>& out) const noexcept;
  /// @param point index into the shell.
  [[nodiscard]] std::size_t region_of(std::size_t point) const noexcept { return region_of_[point]; }

 private:
  std::vector<std::uint8_t> region_of_;  // per shell point
};

}  // namespace burrhole
