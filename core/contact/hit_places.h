/// core/contact/hit_places.h: finds a shell point among the hits of a probe without a scan of all hits.
///   Thread  built once, used by contact. Never allocates after construction.
#pragma once

#include <cstdint>
#include <vector>

#include "core/contact/contact_shell.h"
#include "core/contact/surface_probe.h"

namespace burrhole {

class HitPlaces {
 public:
  explicit HitPlaces(const ContactShell& shell);
  /// @param hits of the cutting part, then of the passive part. @returns the index of the point's hit; hits.count where the point has no
  /// hit or does not exist.
  [[nodiscard]] std::size_t find(const ProbeHits& hits, std::uint32_t point) const noexcept;

 private:
  std::vector<std::uint32_t> place_;  // per shell point: its position in the order of both parts, which hits follow
};

}  // namespace burrhole
