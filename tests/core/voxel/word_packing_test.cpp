// Words straight from densities against a plain loop that stores the float gradient first and rounds it afterwards.
#include "core/voxel/word_packing.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/base/simd.h"

using namespace burrhole;

namespace {

struct Packed {
  ContactWord word;
  std::uint8_t side;
};

/// From the definitions in contact_words.h; `blind` forgets the dead zone (sabotage).
Packed plain(const DensityBlock& block, const Vec3i& v, float dead_zone, bool blind = false) {
  const auto at = [&](int x, int y, int z) { return block.density[block.box.offset_of(v + Vec3i(x, y, z))]; };
  const float g[3] = {0.5f * (at(1, 0, 0) - at(-1, 0, 0)), 0.5f * (at(0, 1, 0) - at(0, -1, 0)), 0.5f * (at(0, 0, 1) - at(0, 0, -1))};
  const bool dead = !blind && g[0] * g[0] + g[1] * g[1] + g[2] * g[2] < dead_zone * dead_zone;
  std::uint32_t word = 0;
  for (int axis = 0; axis < 3 && !dead; ++axis) {
    const float steps = std::min(127.0f, std::max(-127.0f, std::nearbyint(g[axis] * 254.0f)));
    word |= (static_cast<std::uint32_t>(static_cast<int>(steps)) & 0xFFu) << (8 * (axis + 1));
  }
  const float here = at(0, 0, 0);
  const auto rounded = static_cast<std::uint32_t>(std::min(1.0f, std::max(0.0f, here)) * 255.0f + 0.5f);
  const std::uint32_t density = std::max(rounded, here > 0.0f ? 1u : 0u);
  if (word != 0) return {word | density, 0};
  return {kEmptyWord | density, density == 0 ? kSideEmpty : density < 128 ? kSideThin : kSideSolid};
}

/// Densities that cross every rounding: many of a step's own halves, small ones, and some outside 0..1 as a foreign file may hold.
std::vector<float> densities(std::size_t count, std::uint64_t seed) {
  std::vector<float> out;
  for (std::size_t n = 0; n < count; ++n) {
    const double odd = uniform01(seed, 2 * n), value = uniform01(seed, 2 * n + 1);
    out.push_back(static_cast<float>(odd < 0.3    ? std::floor(value * 509.0) / 508.0
                                     : odd < 0.5  ? (value < 0.5 ? 0.0 : 1.0)
                                     : odd < 0.6  ? 1e-3 * value
                                     : odd < 0.9  ? 0.5 + 0.05 * value
                                     : odd < 0.98 ? value
                                                  : 3.0 * value - 1.0));
  }
  return out;
}

}  // namespace

TEST_CASE("word packing: same bits as rounding stored float gradients, at every SIMD level, boxes of every width, nothing beside them") {
  const SimdLevelGuard guard;
  int told_apart = 0;
  for (int width = 1; width <= 40; ++width) {
    CAPTURE(width);
    const VoxelBox target{Vec3i(3, -4, 5), Vec3i(3 + width, -1, 7)}, box{target.lo - Vec3i(1, 2, 1), target.hi + Vec3i(3, 1, 1)};
    const std::vector<float> density = densities(box.count(), static_cast<std::uint64_t>(width));
    for (const float dead_zone : {0.0f, 0.08f, 0.3f})
      for (const SimdLevel level : simd_levels()) {
        CAPTURE(std::string(name_of(level)));
        REQUIRE(choose_simd(name_of(level)).ok());
        std::vector<ContactWord> words(box.count(), 7u);
        std::vector<std::uint8_t> sides(box.count(), 9);
        pack_words({box, density}, target, dead_zone, words, sides);
        for_each_voxel(box, [&](const Vec3i& v) {
          const std::size_t at = box.offset_of(v);
          const Packed expected = target.contains(v) ? plain({box, density}, v, dead_zone) : Packed{7u, 9};
          REQUIRE(words[at] == expected.word);
          REQUIRE(sides[at] == expected.side);
          if (target.contains(v) && plain({box, density}, v, dead_zone, true).word != words[at]) ++told_apart;
        });
      }
  }
  CHECK(told_apart > 100);
}

TEST_CASE("word packing: an empty target writes nothing") {
  const VoxelBox box{Vec3i(0), Vec3i(5)};
  const std::vector<float> density(box.count(), 1.0f);
  std::vector<ContactWord> words(box.count(), 7u);
  std::vector<std::uint8_t> sides(box.count(), 9);
  pack_words({box, density}, {}, 0.0f, words, sides);
  for (const ContactWord word : words) REQUIRE(word == 7u);
}
