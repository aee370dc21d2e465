#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "core/base/random.h"
#include "core/base/simd.h"
#include "core/voxel/gradient.h"

using namespace burrhole;

namespace {

/// The plain loop; `wrong_zone` asks for "at most" instead of "below".
void plain_gradient(const DensityBlock& block, const VoxelBox& target, float dead_zone, const VoxelBox& out_box, std::span<Vec3f> out,
                    bool wrong_zone = false) {
  for_each_voxel(target, [&](const Vec3i& v) {
    const auto at = [&](int x, int y, int z) { return block.density[block.box.offset_of(v + Vec3i(x, y, z))]; };
    const Vec3f g(0.5f * (at(1, 0, 0) - at(-1, 0, 0)), 0.5f * (at(0, 1, 0) - at(0, -1, 0)), 0.5f * (at(0, 0, 1) - at(0, 0, -1)));
    const float length2 = g.x * g.x + g.y * g.y + g.z * g.z, zone2 = dead_zone * dead_zone;
    const bool dead = wrong_zone ? length2 <= zone2 : length2 < zone2;
    out[out_box.offset_of(v)] = dead ? Vec3f(0.0f) : g;
  });
}

bool same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
}

}  // namespace

TEST_CASE("gradient: same bits as a plain loop at every SIMD level, for boxes of every width, and nothing written beside them") {
  const SimdLevelGuard guard;
  int told_apart = 0;
  for (int width = 1; width <= 40; ++width) {
    CAPTURE(width);
    const auto seed = static_cast<std::uint64_t>(width);
    const VoxelBox box{Vec3i(-3, 4, 9), Vec3i(-3 + width + 5, 4 + 9, 9 + 8)};
    const VoxelBox target{box.lo + Vec3i(2, 1, 3), Vec3i(box.lo.x + 2 + width, box.hi.y - 2, box.hi.z - 1)};
    const VoxelBox out_box = width % 2 == 0 ? box : target.grown(2);
    std::vector<float> density(box.count());
    // Steps of 1/8: many gradients have the dead zone's own length.
    for (std::size_t n = 0; n < density.size(); ++n) density[n] = 0.125f * static_cast<float>(static_cast<int>(9.0 * uniform01(seed, n)));
    for (const float zone : {0.0f, 0.0625f, 0.08f, 0.125f, 0.4f}) {
      std::vector<Vec3f> expected(out_box.count(), Vec3f(9.0f)), sabotaged = expected;
      plain_gradient({box, density}, target, zone, out_box, expected);
      plain_gradient({box, density}, target, zone, out_box, sabotaged, true);
      for (const SimdLevel level : simd_levels()) {
        CAPTURE(name_of(level));
        REQUIRE(choose_simd(name_of(level)).ok());
        std::vector<Vec3f> gradient(out_box.count(), Vec3f(9.0f));
        update_gradient({box, density}, target, zone, out_box, gradient);
        CHECK(same_bits(gradient, expected));
        told_apart += same_bits(gradient, sabotaged) ? 0 : 1;
      }
    }
  }
  CHECK(told_apart > 20);
}
