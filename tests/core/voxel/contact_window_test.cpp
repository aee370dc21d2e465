#include "core/voxel/contact_window.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const Vec3i kDims(26, 24, 22);

/// What the master held when it was published, and what is derived from it, made anew: by the same kernels, but with no slide or update.
struct Published {
  MasterWindow master;
  std::uint64_t window_epoch = 0, growth_epoch = 0;
  std::vector<ContactWord> words;
  RecordArray records;
  VoxelBox records_valid;
  std::vector<std::uint8_t> stiffness;
};

/// From the definition: hardness times the factor of the voxel's label, or, where that is not bone, of the first neighbour's that is.
std::uint8_t plain_stiffness(const DenseBone& dense, const Vec3i& v, const LabelFactors& factors) {
  const VoxelBox whole{Vec3i(0), dense.dims};
  if (!whole.contains(v)) return 0;
  const auto label_of = [&](const Vec3i& at) {
    return whole.contains(at) ? static_cast<VoxelLabel>(dense.labels[whole.offset_of(at)]) : VoxelLabel::none;
  };
  float factor = 1.0f;
  for (const auto& step : {Vec3i(0), Vec3i(-1, 0, 0), Vec3i(1, 0, 0), Vec3i(0, -1, 0), Vec3i(0, 1, 0), Vec3i(0, 0, -1), Vec3i(0, 0, 1)}) {
    const VoxelLabel label = label_of(v + step);
    if (label == VoxelLabel::none || label == VoxelLabel::dura || label == VoxelLabel::brain) continue;
    factor = factors[static_cast<std::size_t>(label)];
    break;
  }
  return static_cast<std::uint8_t>(std::floor(dense.hardness[whole.offset_of(v)] * factor * 255.0f + 0.5f));
}

std::vector<std::uint8_t> plain_stiffness(const DenseBone& dense, const VoxelBox& box, const LabelFactors& factors) {
  std::vector<std::uint8_t> out;
  for_each_voxel(box, [&](const Vec3i& v) { out.push_back(plain_stiffness(dense, v, factors)); });
  return out;
}

/// Wavy layers ten voxels thick, across the axis that the seed names: in noise every voxel is beside the surface, here most are as far from
/// it as records go, and nothing is quite along the grid, so a record near a face shows what the window did not know beyond it.
DenseBone layered_bone(const Vec3i& dims, std::uint64_t seed) {
  DenseBone dense = random_bone(dims, seed);
  const VoxelBox whole{Vec3i(0), dims};
  const auto axis = static_cast<std::size_t>(seed % 3);
  for_each_voxel(whole, [&](const Vec3i& v) {
    const Vec3 p(v);
    const double waves = std::sin(0.5 * p.x + 1.0) + std::sin(0.6 * p.y + 2.0) + std::sin(0.7 * p.z + 3.0);
    const double across = p[axis] + 20.0 * uniform01(seed, 1) + 0.2 * p[(axis + 1) % 3] + 0.5 * waves;
    dense.occupancy[whole.offset_of(v)] = static_cast<float>(std::clamp(0.5 + 3.0 * std::sin(0.3 * across), 0.0, 1.0));
  });
  return dense;
}

/// Of what is not felt the factor must not show.
constexpr LabelFactors kFactors{0.9f, 0.8f, 0.7f, 0.3f, 0.5f, 0.9f, 0.9f, 0.2f};

Published published(const Voxmap& voxmap, const ContactFields& fields, const DenseBone& dense) {
  Published out{voxmap.window(), voxmap.window_epoch(), voxmap.growth_epoch(), {}, {}, {}, {}};
  if (fields.words) {
    ContactWords words;
    words.rebuild(out.master);
    out.words = words.words();
  }
  if (fields.records) {
    SurfaceRecords records(voxmap.bone().bone_from_index(), *fields.records);
    records.rebuild(out.master);
    out.records = records.records();
    out.records_valid = records.valid_box();
    out.stiffness = plain_stiffness(dense, out.master.box, fields.label_stiffness);
  }
  return out;
}

/// How many records differ inside the box where they are true.
template <class Record>
std::size_t differing(const VoxelBox& valid, const VoxelBox& box, const std::vector<Record>& a, const std::vector<Record>& b) {
  if (a.size() != box.count() || b.size() != box.count()) return box.count();
  std::size_t count = 0;
  for_each_voxel(valid, [&](const Vec3i& v) {
    const Record &x = a[box.offset_of(v)], &y = b[box.offset_of(v)];
    count += x.distance == y.distance && x.nx == y.nx && x.ny == y.ny && x.nz == y.nz ? 0 : 1;
  });
  return count;
}

bool same_records(const ContactWindow& copy, const Published& expected) {
  if (copy.records_valid != expected.records_valid || copy.records.index() != expected.records.index()) return false;
  return std::visit(
      [&](const auto& records) {
        return differing(copy.records_valid, copy.box, records, std::get<std::decay_t<decltype(records)>>(expected.records)) == 0;
      },
      copy.records);
}

/// Each field of the copy that is asked for against the master and what is made anew from it.
bool same(const ContactWindow& copy, const Published& expected, const ContactFields& fields) {
  const auto is = [](bool asked, const auto& kept, const auto& wanted) { return asked ? kept == wanted : kept.empty(); };
  return copy.box == expected.master.box && copy.window_epoch == expected.window_epoch && copy.growth_epoch == expected.growth_epoch &&
         is(fields.density, copy.density, expected.master.density) && is(fields.gradient, copy.gradient, gradients_of(expected.master)) &&
         is(fields.words, copy.words, expected.words) && copy.stiffness == expected.stiffness &&
         (!fields.records || same_records(copy, expected));
}

/// Up to 4 voxels along one axis, up to 1 along another: a slide, not a jump.
Vec3i random_shift(Dice& dice) {
  Vec3i shift(0);
  const auto axis = static_cast<std::size_t>(dice.next_below(3));
  shift[axis] = dice.next_below(9) - 4;
  shift[(axis + 1) % 3] = dice.next_below(3) - 1;
  return shift;
}

/// One random run of the writer and reader on one thread.
struct Run {
  std::uint64_t seed;
  bool slides;
  ContactFields fields;
  Vec3 edges = Vec3(0.25e-3);  ///< [m]
  Vec3i dims = kDims;
  bool one_thread = false;  ///< one copy: it is the newest at once
  int publishes = 0, mismatches = 0, slid = 0;
  std::uint64_t copied = 0, full = 0, compared_records = 0;

  void operator()() {
    Dice dice{seed};
    DenseBone dense = fields.records ? layered_bone(dims, seed) : random_bone(dims, seed);
    dense.bone_from_index.linear = Mat3(edges.x, 0.0, 0.0, 0.0, edges.y, 0.0, 0.0, 0.0, edges.z);
    Voxmap voxmap = make_voxmap(load_bone(dense));
    PlainTwin twin(dense, 0.08f);
    REQUIRE(voxmap.place_window({Vec3i(0), dims}).ok());
    ContactWindowPublisher publisher(voxmap, fields, one_thread);
    publisher.publish(voxmap);
    Published newest = published(voxmap, fields, dense), taken = newest;
    const ContactWindow* held = &publisher.exchange().latest();
    for (int step = 0; step < 150; ++step) {
      const double choice = dice.next();
      if (choice < 0.45) {
        erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 4), dice);
      } else if (choice < 0.75) {
        publisher.publish(voxmap);
        newest = published(voxmap, fields, dense);
        if (one_thread) taken = newest;
        full += voxmap.window().box.count();
        ++publishes;
      } else if (slides && choice > 0.9) {
        const VoxelBox box = voxmap.window().box;
        const Vec3i shift = random_shift(dice);
        // Where records are true is what lies 6 to 11 voxels in: a small window has none, so with them the box is whole again after a jump.
        const VoxelBox there = fields.records ? VoxelBox{shift, dims + shift} : random_window(voxmap.bone().bounds(), dice);
        REQUIRE(voxmap.place_window(dice.next() < 0.3 ? there : VoxelBox{box.lo + shift, box.hi + shift}).ok());
        ++slid;
      } else {
        held = &publisher.exchange().latest();
        taken = newest;
      }
      mismatches += held == nullptr || !same(*held, taken, fields) ? 1 : 0;
      compared_records += held->records_valid.count();
    }
    copied = publisher.copied_voxels();
    for (std::size_t slot = 1; slot < 3; ++slot) CHECK((publisher.exchange().slots()[slot].bytes() == 0) == one_thread);
    CHECK(publisher.published_epoch() == newest.window_epoch);
  }
};

}  // namespace

TEST_CASE("ContactWindowPublisher: each copy taken equals the master at its publishing, bit for bit, for as long as it is held") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    Run run{seed, seed > 3, {.words = seed % 2 == 0}};
    run();
    CHECK(run.publishes > 20);
    CHECK(run.mismatches == 0);
  }
}

TEST_CASE("ContactWindowPublisher: where one thread writes and reads, the one copy is the newest, bit for bit, and there is no other") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Run run{.seed = seed, .slides = seed > 3, .fields = {.words = seed % 2 == 0}, .one_thread = true};
    run();
    CHECK(run.publishes > 20);
    CHECK(run.mismatches == 0);
  }
}

TEST_CASE("ContactWindowPublisher: records and stiffness after bites and slides along every axis equal a rebuild where they are true") {
  // Long voxels reach fewer of them and thin ones more, so what a slide keeps differs by axis: a margin of one axis for all fails here.
  const Vec3 shapes[] = {Vec3(0.25e-3), Vec3(0.6e-3, 0.3e-3, 0.3e-3), Vec3(1e-3, 1e-3, 0.5e-3), Vec3(0.2e-3, 0.5e-3, 0.9e-3)};
  for (const Vec3& edges : shapes)
    for (const RecordPrecision bits : {RecordPrecision::bits8, RecordPrecision::bits16})
      for (std::uint64_t seed = 21; seed <= 23; ++seed) {
        CAPTURE(seed);
        CAPTURE(edges.x);
        CAPTURE(edges.y);
        CAPTURE(edges.z);
        Run run{.seed = seed,
                .slides = true,
                .fields = {.gradient = false,
                           .words = seed == 22 && bits == RecordPrecision::bits8,
                           .records = bits,
                           .label_stiffness = kFactors},
                .edges = edges,
                .dims = Vec3i(30, 28, 30)};
        run();
        CHECK(run.slid > 5);
        CHECK(run.compared_records > 20'000);
        CHECK(run.mismatches == 0);
      }
}

TEST_CASE("ContactWindowPublisher: the comparison sees one wrong record and one wrong stiffness (sabotage)") {
  const DenseBone dense = random_bone(kDims, 31);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  REQUIRE(voxmap.place_window({Vec3i(0), kDims}).ok());
  const ContactFields fields{.gradient = false, .records = RecordPrecision::bits16, .label_stiffness = kFactors};
  ContactWindowPublisher publisher(voxmap, fields);
  publisher.publish(voxmap);
  const Published expected = published(voxmap, fields, dense);
  const ContactWindow& copy = publisher.exchange().latest();
  REQUIRE(same(copy, expected, fields));
  const std::size_t middle = copy.box.offset_of((copy.records_valid.lo + copy.records_valid.hi) / 2);
  ContactWindow wrong = copy;
  ++std::get<std::vector<Record16>>(wrong.records)[middle].nz;
  CHECK_FALSE(same(wrong, expected, fields));
  wrong = copy;
  ++wrong.stiffness[middle];
  CHECK_FALSE(same(wrong, expected, fields));
  wrong = copy;
  --wrong.records_valid.hi.y;
  CHECK_FALSE(same(wrong, expected, fields));
}

TEST_CASE("ContactWindowPublisher: copies only what a slot missed, far below a whole window each time") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Run run{seed, false, {}};
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

TEST_CASE("ContactWindowPublisher: a reader that never comes costs only its list of boxes, and then finds the newest") {
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
  CHECK(same(publisher.exchange().latest(), published(voxmap, {}, dense), {}));
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
  const DenseBone dense = random_bone(Vec3i(90, 30, 30), 3);
  Voxmap voxmap = make_voxmap(load_bone(dense));
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
  CHECK(same(publisher.exchange().latest(), published(voxmap, {}, dense), {}));
}

TEST_CASE("contact window: stiffness is hardness times the factor of the label, read off for every voxel, also after a slide") {
  DenseBone dense = random_bone(kDims, 11);
  Dice dice{12};
  for (std::uint8_t& label : dense.labels) label = static_cast<std::uint8_t>(dice.next_below(kVoxelLabels));
  Voxmap voxmap = make_voxmap(load_bone(dense));
  REQUIRE(voxmap.place_window({Vec3i(0), kDims - Vec3i(4, 0, 0)}).ok());
  ContactWindowPublisher publisher(voxmap, {.records = RecordPrecision::bits16, .label_stiffness = kFactors});
  const auto is_of = [&](const LabelFactors& factors) {
    const ContactWindow& copy = publisher.exchange().latest();
    return copy.stiffness == plain_stiffness(dense, copy.box, factors);
  };
  publisher.publish(voxmap);
  CHECK(is_of(kFactors));
  CHECK_FALSE(is_of(kAllAlike));  // sabotage: factors forgotten
  REQUIRE(voxmap.place_window({Vec3i(4, 0, 0), kDims}).ok());
  publisher.publish(voxmap);
  CHECK(is_of(kFactors));
}
