#include "core/voxel/contact_window.h"

#include <doctest/doctest.h>

#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const Vec3i kDims(26, 24, 22);

/// What the master held when it was published.
struct Published {
  MasterWindow master;
  std::uint64_t window_epoch = 0, growth_epoch = 0;
};

Published published(const Voxmap& voxmap) { return {voxmap.window(), voxmap.window_epoch(), voxmap.growth_epoch()}; }

bool same(const ContactWindow& copy, const Published& expected) {
  if (!copy.words.empty()) {
    ContactWords rebuilt;
    rebuilt.rebuild(expected.master);
    if (copy.words != rebuilt.words()) return false;
  }
  return copy.box == expected.master.box && copy.density == expected.master.density && copy.gradient == expected.master.gradient &&
         copy.window_epoch == expected.window_epoch && copy.growth_epoch == expected.growth_epoch;
}

/// One random run of the writer and reader on one thread.
struct Run {
  std::uint64_t seed;
  bool slides, words;
  int publishes = 0, mismatches = 0;
  std::uint64_t copied = 0, full = 0;

  void operator()() {
    Dice dice{seed};
    const DenseBone dense = random_bone(kDims, seed);
    Voxmap voxmap = make_voxmap(load_bone(dense));
    PlainTwin twin(dense, 0.08f);
    REQUIRE(voxmap.place_window({Vec3i(0), kDims}).ok());
    ContactWindowPublisher publisher(voxmap, {.words = words});
    publisher.publish(voxmap);
    Published newest = published(voxmap), taken = newest;
    const ContactWindow* held = &publisher.exchange().latest();
    for (int step = 0; step < 150; ++step) {
      const double choice = dice.next();
      if (choice < 0.45) {
        erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 4), dice);
      } else if (choice < 0.75) {
        publisher.publish(voxmap);
        newest = published(voxmap);
        full += voxmap.window().box.count();
        ++publishes;
      } else if (slides && choice > 0.95) {
        const VoxelBox box = voxmap.window().box;
        const Vec3i shift(dice.next_below(9) - 4, dice.next_below(3) - 1, 0);
        const bool jump = dice.next() < 0.3;
        REQUIRE(voxmap.place_window(jump ? random_window(voxmap.bone().bounds(), dice) : VoxelBox{box.lo + shift, box.hi + shift}).ok());
      } else {
        held = &publisher.exchange().latest();
        taken = newest;
      }
      mismatches += held == nullptr || !same(*held, taken) ? 1 : 0;
    }
    copied = publisher.copied_voxels();
    CHECK(publisher.published_epoch() == newest.window_epoch);
  }
};

}  // namespace

TEST_CASE("ContactWindowPublisher: each copy taken equals the master at its publishing, bit for bit, for as long as it is held") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    Run run{seed, seed > 3, seed % 2 == 0};
    run();
    CHECK(run.publishes > 20);
    CHECK(run.mismatches == 0);
  }
}

TEST_CASE("ContactWindowPublisher: copies only what a slot missed, far below a whole window each time") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Run run{seed, false, false};
    run();
    const double share = static_cast<double>(run.copied) / static_cast<double>(run.full);
    MESSAGE("seed " << seed << ": copied " << 100.0 * share << " % of " << run.publishes << " whole windows");
    // Three whole copies to begin with (7 % here), then each bite, halo included at most 216 of 13728 voxels, once for each slot.
    CHECK(share < 0.25);
  }
}

TEST_CASE("ContactWindowPublisher: publishing without a change copies nothing") {
  const DenseBone dense = random_bone(kDims, 1);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  REQUIRE(voxmap.place_window({Vec3i(0), kDims}).ok());
  ContactWindowPublisher publisher(voxmap);
  // Each of the three slots comes round to the writer once the reader takes what it is offered.
  for (int n = 0; n < 6; ++n) {
    publisher.publish(voxmap);
    static_cast<void>(publisher.exchange().latest());
  }
  const std::uint64_t whole = publisher.copied_voxels();
  CHECK(whole == 3 * voxmap.window().box.count());
  for (int n = 0; n < 10; ++n) publisher.publish(voxmap);
  CHECK(publisher.copied_voxels() == whole);
}

TEST_CASE("ContactWindowPublisher: a reader that never comes costs nothing but its boxes, and then finds the newest") {
  const DenseBone dense = random_bone(kDims, 2);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  PlainTwin twin(dense, 0.08f);
  Dice dice{5};
  REQUIRE(voxmap.place_window({Vec3i(0), kDims}).ok());
  ContactWindowPublisher publisher(voxmap);
  for (int n = 0; n < 100; ++n) {
    erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 3), dice);
    publisher.publish(voxmap);
  }
  CHECK(same(publisher.exchange().latest(), published(voxmap)));
  CHECK(difference(voxmap.window(), twin) == "");
}

TEST_CASE("ContactWindowPublisher: a field that is not asked for has no memory") {
  Voxmap voxmap = make_voxmap(load_bone(random_bone(kDims, 3)));
  REQUIRE(voxmap.place_window({Vec3i(0), kDims}).ok());
  const std::size_t count = voxmap.window().box.count();
  const auto bytes = [&](const ContactFields& fields) {
    ContactWindowPublisher publisher(voxmap, fields);
    for (int n = 0; n < 4; ++n) {
      publisher.publish(voxmap);
      const ContactWindow& copy = publisher.exchange().latest();
      CHECK(copy.density.capacity() == (fields.density ? count : 0));
      CHECK(copy.gradient.capacity() == (fields.gradient ? count : 0));
      CHECK(copy.words.capacity() == (fields.words ? count : 0));
    }
    return publisher.bytes();
  };
  CHECK(bytes({false, false, false}) == 0);
  CHECK(bytes({true, false, false}) == 3 * count * sizeof(float));
  CHECK(bytes({false, true, false}) == 3 * count * sizeof(Vec3f));
  CHECK(bytes({false, false, true}) > 4 * count * sizeof(ContactWord));  // three copies, the master's, two bytes a voxel of scratch
  CHECK(bytes({false, false, true}) < 6 * count * sizeof(ContactWord));
}

TEST_CASE("ContactWindowPublisher: a slide copies what is new, not the whole window") {
  Voxmap voxmap = make_voxmap(load_bone(random_bone(Vec3i(90, 30, 30), 3)));
  const VoxelBox box{Vec3i(0), Vec3i(64, 30, 30)};
  REQUIRE(voxmap.place_window(box).ok());
  ContactWindowPublisher publisher(voxmap);
  for (int n = 0; n < 4; ++n) {
    publisher.publish(voxmap);
    static_cast<void>(publisher.exchange().latest());
  }
  const std::uint64_t before = publisher.copied_voxels();
  REQUIRE(voxmap.place_window({box.lo + Vec3i(4, 0, 0), box.hi + Vec3i(4, 0, 0)}).ok());
  publisher.publish(voxmap);
  // Four new layers of 64, the old outermost one whose gradients were unknown, the new outermost one.
  CHECK(publisher.copied_voxels() - before == 6 * 30 * 30);
  CHECK(same(publisher.exchange().latest(), published(voxmap)));
}
