#include "core/drill/removal_pass.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "core/base/simd.h"
#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Exposures from nothing to far beyond what clears a voxel, a third of them none.
ExposureField random_exposure(const MasterWindow& window, const VoxelBox& part, std::uint64_t seed) {
  ExposureField field;
  field.place(window, part);
  field.unit = 0x1p-30;
  for_each_voxel(part, [&](const Vec3i& v) {
    const std::size_t at = field.box.offset_of(v);
    const double size = uniform01(seed, 2 * at);
    field.sums[at] = size < 0.33 ? 0 : static_cast<std::int64_t>(std::exp(45.0 * uniform01(seed, 2 * at + 1) - 5.0));
  });
  return field;
}

/// The law voxel by voxel, plainly. @returns remaining of the window; `mass` in another order than the pass.
std::vector<float> plain_removal(const MasterWindow& window, const RemovalLaw& law, const ExposureField& field, double& mass) {
  std::vector<float> remaining = window.remaining;
  mass = 0.0;
  for_each_voxel(field.box.intersect(window.box), [&](const Vec3i& v) {
    const double exposure = field.at(v);
    const std::size_t at = window.box.offset_of(v);
    if (exposure == 0.0 || window.occupancy[at] == 0.0f) return;
    const double hardness = law.by_hardness ? static_cast<double>(std::max(window.hardness[at], law.least_hardness)) : 1.0;
    const double power = -(exposure * law.scale) * law.dt / hardness;
    float after = static_cast<float>(static_cast<double>(remaining[at]) * portable_exp(power));
    if (window.occupancy[at] * after < law.minimum_density) after = 0.0f;
    mass += static_cast<double>(window.occupancy[at]) * (static_cast<double>(remaining[at]) - static_cast<double>(after));
    remaining[at] = after;
  });
  return remaining;
}

}  // namespace

TEST_CASE("removal pass: same bits as a plain loop at every SIMD level, in both laws and at all minimum densities") {
  const SimdLevelGuard guard;
  for (std::uint64_t seed = 1; seed <= 12; ++seed)
    for (const bool by_hardness : {true, false})
      for (const float minimum : {0.0f, 0.05f, 0.4f}) {
        CAPTURE(seed);
        CAPTURE(by_hardness);
        CAPTURE(minimum);
        const RemovalLaw law{.scale = 37.3 * uniform01(seed, 1), .dt = 1e-3, .by_hardness = by_hardness, .minimum_density = minimum};
        const Vec3i dims(17 + static_cast<int>(seed), 14, 13);
        const VoxelBox part{Vec3i(static_cast<int>(seed % 5), 1, 0), dims - Vec3i(static_cast<int>(seed % 3), 0, 2)};
        std::vector<float> first;
        double first_mass = 0.0;
        for (const SimdLevel level : simd_levels()) {
          REQUIRE(choose_simd(name_of(level)).ok());
          Voxmap voxmap = random_block(dims, 0.5e-3, seed);
          for (std::size_t n = 0; n < voxmap.remaining().size(); n += 3)
            voxmap.remaining()[n] = static_cast<float>(uniform01(seed + 40, n));
          const MasterWindow before = voxmap.window();
          ExposureField field = random_exposure(before, part, seed);
          double mass = 0.0;
          const std::vector<float> expected = plain_removal(before, law, field, mass);
          RemovalLaw faster = law;
          faster.scale *= 1.01;
          double wrong_mass = 0.0;
          const std::vector<float> sabotaged = plain_removal(before, faster, field, wrong_mass);
          TileMarks marks;
          marks.reset(before.box);
          const Removal removal = apply_removal(voxmap, law, field, marks);
          CHECK(voxmap.window().remaining == expected);
          CHECK(voxmap.window().remaining != sabotaged);
          CHECK(std::abs(removal.mass - mass) <= 1e-12 * mass);  // some thousand sums in another order
          CHECK(std::ranges::all_of(field.sums, [](std::int64_t sum) { return sum == 0; }));
          const VoxelBoxes boxes = marks.boxes();
          std::uint32_t lost = 0;
          int uncovered = 0;
          for_each_voxel(before.box, [&](const Vec3i& v) {
            const std::size_t at = before.box.offset_of(v);
            if (voxmap.window().remaining[at] == before.remaining[at]) return;
            ++lost;
            uncovered += boxes.contains(v) ? 0 : 1;
          });
          CHECK(removal.voxels == lost);
          CHECK(uncovered == 0);
          CHECK(before.erodible_box().contains(boxes.bounds()));
          if (first.empty()) {
            first = voxmap.window().remaining;
            first_mass = removal.mass;
          }
          CHECK(voxmap.window().remaining == first);
          CHECK(removal.mass == first_mass);
        }
        CHECK(first_mass > 0.0);
      }
}
