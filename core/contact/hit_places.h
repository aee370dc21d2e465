/// core/contact/hit_places.h: where a point of the shell is among the hits of a look, without asking all of them.
///   Thread  built once; contact finds. Never allocates after construction.
#pragma once

#include <cstdint>
#include <vector>

#include "core/contact/contact_shell.h"
#include "core/contact/surface_probe.h"

namespace burrhole {

class HitPlaces {
 public:
  explicit HitPlaces(const ContactShell& shell);
  /// @param hits of the cutting part, then of the passive one. @returns where the point is; hits.count where it is none of them, or no
  /// point.
  [[nodiscard]] std::size_t find(const ProbeHits& hits, std::uint32_t point) const noexcept;

 private:
  std::vector<std::uint32_t> place_;  // a point of the shell: its place among the points of both parts, which hits keep to
};

}  // namespace burrhole
