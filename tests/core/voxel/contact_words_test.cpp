// Packed words against a plain twin: densities, gradients and leaps one voxel at a time from their definitions.
#include "core/voxel/contact_words.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/simd.h"
#include "core/voxel/contact_window.h"
#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

struct Decoded {
  int density, leap;  // leap 0 where there is a gradient
  int gradient[3];
};

Decoded decoded(ContactWord word) {
  const auto part = [&](int byte) { return int(std::int8_t((word >> (8 * byte)) & 255u)); };
  if (part(3) == -128) return {int(word & 255u), int((word >> 8) & 255u), {0, 0, 0}};
  return {int(word & 255u), 0, {part(1), part(2), part(3)}};
}

struct Field {
  VoxelBox box;
  const std::vector<ContactWord>& words;
  Decoded at(int i, int j, int k) const {
    const auto nx = std::size_t(box.hi.x - box.lo.x), ny = std::size_t(box.hi.y - box.lo.y);
    return decoded(words[std::size_t(i - box.lo.x) + nx * (std::size_t(j - box.lo.y) + ny * std::size_t(k - box.lo.z))]);
  }
};

int side(int density) { return density == 0 ? 0 : density < 128 ? 1 : 2; }

/// Whether all voxels nearer than `leap` are still, on one side and off the outermost layer.
bool safe(const Field& field, const Vec3i& v, int leap) {
  const int here = side(field.at(v.x, v.y, v.z).density);
  for (int k = v.z - leap + 1; k < v.z + leap; ++k)
    for (int j = v.y - leap + 1; j < v.y + leap; ++j)
      for (int i = v.x - leap + 1; i < v.x + leap; ++i) {
        if (i <= field.box.lo.x || j <= field.box.lo.y || k <= field.box.lo.z) return false;
        if (i >= field.box.hi.x - 1 || j >= field.box.hi.y - 1 || k >= field.box.hi.z - 1) return false;
        const Decoded other = field.at(i, j, k);
        if (other.leap == 0 || side(other.density) != here) return false;
      }
  return true;
}

/// First fault of the words of a window, or "": rounding, gradients, safety of every leap, and no leap shorter than it could be by more
/// than the one voxel by which a change of side without gradient is seen from both its faces.
std::string fault(const MasterWindow& window, const std::vector<ContactWord>& words) {
  const Field field{window.box, words};
  const VoxelBox valid{window.box.lo + 1, window.box.hi - 1};
  const std::vector<Vec3f> gradients = gradients_of(window);
  std::string found;
  const auto say = [&](const char* what, const Vec3i& v) {
    if (found.empty()) found = std::string(what) + " at " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
  };
  std::size_t n = 0;
  for_each_voxel(window.box, [&](const Vec3i& v) {
    const float d = window.density[n];
    const Vec3f g = gradients[n];
    const ContactWord word = words[n++];
    const Decoded here = decoded(word);
    if (!valid.contains(v)) {
      if (word != 0x80000100u) say("outermost layer", v);
      return;
    }
    // Half a step of 1/255, and half more where rounding to 0 is not allowed.
    if (std::abs(here.density / 255.0 - double(d)) > (here.density == 1 ? 1.0 : 0.5) / 255.0 + 1e-6) say("density", v);
    if ((d > 0.0f) != (here.density > 0) || (d >= 0.5f) != (here.density >= 128)) say("side", v);
    bool still = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::abs(here.gradient[axis] / 254.0 - double(g[axis])) > 0.5 / 254.0 + 1e-6) say("gradient", v);
      still = still && std::abs(double(g[axis])) * 254.0 <= 0.5;
    }
    if (still != (here.leap > 0)) say("still", v);
    if (here.leap > kMaxLeap) say("leap above its bound", v);
    if (here.leap > 1 && !safe(field, v, here.leap)) say("unsafe leap", v);
    if (here.leap > 0 && here.leap + 2 <= kMaxLeap && safe(field, v, here.leap + 2)) say("timid leap", v);
  });
  return found;
}

/// A box of bone with a little noise in air and soft places inside, so that sides change without a gradient and leaps are long.
DenseBone quiet_bone(const Vec3i& dims, std::uint64_t seed) {
  DenseBone dense = random_bone(dims, seed);
  std::size_t n = 0;
  for_each_voxel({Vec3i(0), dims}, [&](const Vec3i& v) {
    const float noise = dense.occupancy[n] * 0.02f;
    const bool soft = (v.x / 6 + v.y / 9 + v.z / 7) % 4 == 3;
    dense.occupancy[n++] = v.x < dims.x / 2 ? (soft ? 0.49f : 0.9f) + noise : (v.y < dims.y / 2 ? 0.0f : noise);
  });
  return dense;
}

}  // namespace

TEST_CASE("ContactWords: every word is its voxel, rounded as stated, and every leap is safe and long") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const Vec3i dims(61, 37, 29);
    const DenseBone dense = seed % 2 == 0 ? quiet_bone(dims, seed) : random_bone(dims, seed);
    Voxmap voxmap = make_voxmap(load_bone(dense));
    REQUIRE(voxmap.place_window({Vec3i(-9), dims + Vec3i(7, 12, 3)}).ok());
    ContactWords words;
    words.rebuild(voxmap.window());
    CHECK(fault(voxmap.window(), words.words()) == "");
    if (seed % 2 != 0) continue;
    std::array<int, kMaxLeap + 1> count{};
    for (const ContactWord word : words.words()) ++count.at(std::size_t(decoded(word).leap));
    for (int leap = 0; leap <= kMaxLeap; ++leap) CHECK(count.at(std::size_t(leap)) > 0);  // all lengths were met
  }
}

TEST_CASE("ContactWords: a leap that erosion made stale is detected (sabotage)") {
  const Vec3i dims(40, 40, 40);
  Voxmap voxmap = make_voxmap(load_bone(quiet_bone(dims, 2)));
  REQUIRE(voxmap.place_window({Vec3i(-4), dims + 4}).ok());
  ContactWords words;
  words.rebuild(voxmap.window());
  const VoxelBox bite{Vec3i(8), Vec3i(11)};
  for_each_voxel(bite, [&](const Vec3i& v) { voxmap.remaining()[voxmap.window().box.offset_of(v)] = 0.0f; });
  voxmap.commit(bite);
  ContactWords fresh;
  fresh.rebuild(voxmap.window());
  // Density and gradient of the present step, leaps of the last one.
  std::vector<ContactWord> torn = fresh.words();
  int stale = 0;
  for (std::size_t n = 0; n < torn.size(); ++n)
    if (decoded(torn[n]).leap > 0 && decoded(words.words()[n]).leap > decoded(torn[n]).leap) {
      torn[n] = (torn[n] & 0xFFFF00FFu) | (words.words()[n] & 0xFF00u);
      ++stale;
    }
  CHECK(stale > 10);  // the bite lies among soft places, where leaps are short
  CHECK(fault(voxmap.window(), fresh.words()) == "");
  CHECK(fault(voxmap.window(), torn).find("unsafe leap") == 0);
}

TEST_CASE("ContactWords: kept up box by box and through slides they equal a rebuild, bit for bit") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    const Vec3i dims(50, 44, 38);
    const DenseBone dense = seed % 2 == 0 ? quiet_bone(dims, seed) : random_bone(dims, seed);
    Voxmap voxmap = make_voxmap(load_bone(dense));
    PlainTwin twin(dense, 0.08f);
    REQUIRE(voxmap.place_window({Vec3i(0), Vec3i(36, 34, 30)}).ok());
    const std::size_t listener = voxmap.add_listener();
    ContactWords kept;
    kept.rebuild(voxmap.window());
    for (int step = 0; step < 60; ++step) {
      CAPTURE(step);
      if (dice.next() < 0.2) {
        const Vec3i shift(dice.next_below(19) - 9, dice.next_below(3) * 4 - 4, dice.next_below(9) - 4);
        const VoxelBox box = voxmap.window().box;
        const int wider = dice.next() < 0.2 ? 3 : 0;
        REQUIRE(voxmap.place_window({box.lo + shift, box.hi + shift + wider}).ok());
        kept.slide(voxmap.window());
      }
      erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 9), dice);
      for (const VoxelBox& dirty : voxmap.take_dirty(listener)) {
        const std::vector<ContactWord> before = kept.words();
        const VoxelBox changed = kept.update(voxmap.window(), dirty);
        bool outside = false;
        for_each_voxel(kept.box(), [&](const Vec3i& v) {
          const std::size_t at = kept.box().offset_of(v);
          outside = outside || (before[at] != kept.words()[at] && !changed.contains(v));
        });
        CHECK_FALSE(outside);
      }
      ContactWords fresh;
      fresh.rebuild(voxmap.window());
      REQUIRE(kept.box() == fresh.box());
      REQUIRE(kept.words() == fresh.words());
    }
    CHECK(fault(voxmap.window(), kept.words()) == "");
  }
}

TEST_CASE("ContactWords: all SIMD levels give the same words") {
  const SimdLevelGuard guard;
  const Vec3i dims(70, 23, 19);
  Voxmap voxmap = make_voxmap(load_bone(quiet_bone(dims, 4)));
  REQUIRE(voxmap.place_window({Vec3i(-6), dims + 5}).ok());
  ContactWords best;
  best.rebuild(voxmap.window());
  for (const SimdLevel level : simd_levels()) {
    REQUIRE(choose_simd(name_of(level)).ok());
    ContactWords words;
    words.rebuild(voxmap.window());
    CHECK(words.words() == best.words());
  }
}

TEST_CASE("ContactWords: the smallest window and one of the longest edge hold") {
  const DenseBone dense = random_bone(Vec3i(24), 3);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  for (const VoxelBox& box : {VoxelBox{Vec3i(4), Vec3i(9)}, VoxelBox{Vec3i(-100, 3, 3), Vec3i(156, 9, 8)}}) {
    REQUIRE(voxmap.place_window(box).ok());
    ContactWords words;
    words.rebuild(voxmap.window());
    CHECK(fault(voxmap.window(), words.words()) == "");
  }
}
