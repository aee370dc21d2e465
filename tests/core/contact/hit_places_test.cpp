// Where a point is among hits, against a plain search.
#include "core/contact/hit_places.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/base/random.h"

using namespace burrhole;

namespace {

PointShell shell_of(std::size_t count) {
  PointShell shell;
  for (std::uint64_t n = 0; n < count; ++n) {
    shell.positions.push_back(4e-3 * Vec3(uniform11(6, 3 * n), uniform11(6, 3 * n + 1), uniform11(6, 3 * n + 2)));
    shell.inward_normals.push_back({0.0, 0.0, 1.0});
    shell.cutting.push_back(n % 4 != 0);
  }
  return shell;
}

/// Every hit that `chosen` says, of the cutting part, then of the passive one.
template <class Chosen>
ProbeHits hits_of(const ContactShell& shell, Chosen&& chosen) {
  ProbeHits hits;
  for (const ContactShellPart* part : {&shell.cutting, &shell.passive})
    for (const std::uint32_t point : part->point)
      if (chosen(point)) hits.point.push_back(point);
  hits.count = hits.point.size();
  hits.point.resize(hits.count + 5, 0);  // what an earlier look left
  return hits;
}

/// Points that are not found where a plain search finds them.
int wrong(const HitPlaces& places, const ProbeHits& hits, std::uint32_t points) {
  int out = 0;
  const auto end = hits.point.begin() + static_cast<std::ptrdiff_t>(hits.count);
  for (std::uint32_t point = 0; point < points; ++point)
    out += places.find(hits, point) != static_cast<std::size_t>(std::find(hits.point.begin(), end, point) - hits.point.begin());
  return out;
}

}  // namespace

TEST_CASE("hit places: every point is found where a plain search finds it") {
  for (const std::uint32_t count : {1u, 4u, 17u, 500u}) {
    const ContactShell shell = make_contact_shell(shell_of(count), 0.25e-3);
    const HitPlaces places(shell);
    for (const std::uint32_t every : {1u, 2u, 7u}) {
      ProbeHits hits = hits_of(shell, [&](std::uint32_t point) { return mix64(point) % every == 0; });
      CHECK(wrong(places, hits, count + 3) == 0);  // those beyond the shell are nowhere
      if (count == 500) {
        std::swap(hits.point[3], hits.point[40]);
        CHECK(wrong(places, hits, count) > 0);  // sabotage: hits out of order are missed
      }
    }
    CHECK(wrong(places, hits_of(shell, [](std::uint32_t) { return false; }), count) == 0);
  }
}
