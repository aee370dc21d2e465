#include "core/contact/hit_places.h"

#include <algorithm>

namespace burrhole {

HitPlaces::HitPlaces(const ContactShell& shell) : place_(shell.cutting.size() + shell.passive.size()) {
  std::uint32_t place = 0;
  for (const ContactShellPart* part : {&shell.cutting, &shell.passive})
    for (const std::uint32_t point : part->point) place_[point] = place++;
}

std::size_t HitPlaces::find(const ProbeHits& hits, std::uint32_t point) const noexcept {
  if (point >= place_.size()) return hits.count;
  const auto begin = hits.point.begin(), end = begin + static_cast<std::ptrdiff_t>(hits.count);
  const auto found = std::ranges::lower_bound(begin, end, place_[point], {}, [&](std::uint32_t p) { return place_[p]; });
  return found != end && *found == point ? static_cast<std::size_t>(found - begin) : hits.count;
}

}  // namespace burrhole
