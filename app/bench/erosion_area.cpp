#include <fmt/format.h>

#include "app/bench/areas.h"
#include "app/bench/bench_scene.h"
#include "app/bench/vdb_baselines.h"
#include "core/base/random.h"
#include "core/voxel/word_packing.h"

namespace burrhole {
namespace {

constexpr double kErosionPitch = 0.0668e-3;  // [m] gives the head of the 5 mm burr about 220,000 points
constexpr double kDt = 0.01;                 // [s] the shipped scene's step

/// The shipped bone and a slightly tilted 5 mm burr whose head lies completely inside it.
struct BuriedBurr {
  std::unique_ptr<LoadedScene> loaded;
  Tool burr;
  std::unique_ptr<Voxmap> voxmap;
  Affine index_from_tool;
  std::vector<float> as_placed;  // remaining of the window

  void put_back() { std::ranges::copy(as_placed, voxmap->remaining().begin()); }
};

Result<BuriedBurr> bury_burr() {
  auto loaded = load_parietal_scene({});
  if (!loaded) return loaded.error();
  BuriedBurr out;
  out.loaded = std::move(loaded).value();
  auto burr = load_shipped_tool("round_burr_5mm", kErosionPitch);
  if (!burr) return burr.error();
  out.burr = std::move(burr).value();
  const auto approach = make_approach(*out.loaded->bone, out.loaded->scene.approach);
  if (!approach) return approach.error();
  auto voxmap = Voxmap::create(out.loaded->bone, {});
  if (!voxmap) return voxmap.error();
  out.voxmap = std::make_unique<Voxmap>(std::move(voxmap).value());
  const Pose approach_from_tool{rotation_from_z(glm::normalize(Vec3(0.05, 0.03, 1.0))),
                                Vec3(0.21e-3, 0.13e-3, -0.5 * approach->thickness - 2.5e-3)};
  out.index_from_tool =
      out.loaded->bone->bone_from_index().inverse() * Affine::from_pose(approach->bone_from_approach * approach_from_tool);
  if (Status placed = out.voxmap->place_window(
          tool_box(out.burr, out.index_from_tool,
                   window_margins(out.loaded->scene.effects.needs(out.loaded->scene).fields, out.loaded->bone->bone_from_index()).placed));
      !placed)
    return placed.error();
  out.as_placed = out.voxmap->window().remaining;
  return out;
}

/// @returns the same points in random order.
ErosionPoints shuffled(const ErosionPoints& points) {
  ErosionPoints out = points;
  for (std::size_t n = points.size() - 1; n > 0; --n) {
    const auto other = static_cast<std::size_t>(uniform01(11, n) * static_cast<double>(n + 1));
    std::swap(out.positions[n], out.positions[other]);
    std::swap(out.factors[n], out.factors[other]);
  }
  return out;
}

/// A case that is compared with value accessors.
struct LawCase {
  ErosionLaw law = ErosionLaw::rate;
  double spin = 0.0;  // [rev/s] for the rate law; s of eq. 4 for the other
  bool random_order = false;
  Bars bars;
};

/// Times one step of a law on the window; the baseline uses value accessors. Both start from the same bone.
Status compare_laws(Bench& bench, BuriedBurr& bone, const LawCase& c) {
  const ErosionLaw law = c.law;
  const double spin = c.spin;
  const ErosionPoints points = c.random_order ? shuffled(bone.burr.erosion) : bone.burr.erosion;
  auto erosion = Erosion::create({.law = law}, points);
  if (!erosion) return erosion.error();
  bone.put_back();
  VdbErosion by_accessors(points, bone.voxmap->window());
  const VdbErosionStep step{.index_from_tool = bone.index_from_tool, .spin = spin, .dt = kDt};
  ErosionOutcome outcome;
  const Side window{[&] { bone.put_back(); },
                    [&] {
                      outcome = erosion->step(*bone.voxmap, {bone.index_from_tool, bone.index_from_tool}, spin, kDt);
                    }};
  const Side accessors{[&] { by_accessors.reset(); },
                       [&] {
                         if (law == ErosionLaw::rate)
                           by_accessors.step_rate(step);
                         else
                           by_accessors.step_per_update(step);
                       }};
  window.prepare();
  window.run();
  accessors.prepare();
  accessors.run();
  const Vec3i size = outcome.changed.bounds().size();
  const std::string name = fmt::format("{}, {} points in {} order, {} x {} x {} voxels", law == ErosionLaw::rate ? "rate law" : "eq. 4",
                                       points.size(), c.random_order ? "random" : "lattice", size.x, size.y, size.z);
  const bool cut = bench.require(name, outcome.changed.count() > 4000 && outcome.outside == 0, "the head of the burr is not inside bone");
  if (cut && bench.agree(name, bytes_of(by_accessors.remaining()), bytes_of(bone.voxmap->window().remaining)))
    bench.add_speed_up(name, "ns/point", 1e9 / static_cast<double>(points.size()), bench.time(accessors, window), c.bars);
  bone.put_back();
  return {};
}

/// Times a step of the gather form; the baseline is the scatter form. Gather is an approximation, so the removed masses are compared.
Status compare_forms(Bench& bench, BuriedBurr& bone, double spin) {
  auto scatter = Erosion::create({}, bone.burr.erosion), gather = Erosion::create({.form = ErosionForm::gather}, bone.burr.erosion);
  if (!scatter) return scatter.error();
  if (!gather) return gather.error();
  const ErosionPath rest{bone.index_from_tool, bone.index_from_tool};
  double exact = 0.0, approximate = 0.0;
  const auto side = [&](Erosion& erosion, double& mass) {
    return Side{[&] { bone.put_back(); }, [&] { mass = erosion.step(*bone.voxmap, rest, spin, kDt).removed_mass; }};
  };
  const Side by_scatter = side(*scatter, exact), by_gather = side(*gather, approximate);
  for (const Side& each : {by_scatter, by_gather}) {
    each.prepare();
    each.run();
  }
  const std::string name = fmt::format("gather form over scatter form, {} points", bone.burr.erosion.size());
  // The table blurs the rim by less than half a voxel, inwards and outwards, at a radius of ten. Repeated steps are bit-identical.
  const bool alike = bench.require(name, exact > 0.0 && std::abs(approximate / exact - 1.0) < 0.03, "the forms remove different masses");
  const std::vector<float> once = bone.voxmap->window().remaining;
  by_gather.prepare();
  by_gather.run();
  if (alike && bench.agree(name, bytes_of(once), bytes_of(bone.voxmap->window().remaining)))
    bench.add_speed_up(name, "us", 1e6, bench.time(by_scatter, by_gather));
  bone.put_back();
  return {};
}

/// Times the exposure without the law: look-up in the tool's table; the baseline counts points, with a result that is independent of order.
void compare_exposures(Bench& bench, const BuriedBurr& bone) {
  const ErosionPoints& points = bone.burr.erosion;
  const std::vector<double> weights(points.factors.begin(), points.factors.end());
  const StrengthField strength(points, weights, bone.voxmap->bone().bone_from_index().mean_edge());
  PointScatter scatter(points), other(shuffled(points));
  ExposureField found, counted, counted_otherwise;
  const MasterWindow& window = bone.voxmap->window();
  const Side look_up{{}, [&] { strength.look_up(window, bone.index_from_tool, found); }};
  const Side count{[&] { std::ranges::fill(counted.sums, 0); }, [&] { (void)scatter.add(window, bone.index_from_tool, counted); }};
  const std::string name = "exposure alone: table look-up over counting points";
  count.run();
  (void)other.add(window, bone.index_from_tool, counted_otherwise);
  if (bench.agree(name, bytes_of(counted.sums), bytes_of(counted_otherwise.sums)))
    bench.add_speed_up(name, "us", 1e6, bench.time(count, look_up));
}

/// A complete simulation step: erosion, gradients, and publishing of the fields that a contact model reads, with density for the monitor.
struct StepCase {
  ErosionConfig erosion;
  std::optional<ContactFields> publishing;
  std::string what;
};

std::vector<StepCase> step_cases() {
  const ContactFields words{.density = true, .gradient = false, .words = true};
  const auto records = [](RecordPrecision precision) {
    return ContactFields{.density = true, .gradient = false, .words = false, .records = precision};
  };
  const ErosionConfig scatter, gather{.form = ErosionForm::gather}, subvoxel{.subvoxel = true};
  return {{scatter, {}, "erosion by points, gradient"},
          {scatter, words, "erosion by points, gradient, words and leaps published"},
          {scatter, records(RecordPrecision::bits8), "erosion by points, gradient, records of 8 bits published"},
          {scatter, records(RecordPrecision::bits16), "erosion by points, gradient, records of 16 bits published"},
          {gather, {}, "erosion by table, gradient"},
          {gather, words, "erosion by table, gradient, words and leaps published"},
          {gather, records(RecordPrecision::bits16), "erosion by table, gradient, records of 16 bits published"},
          {subvoxel, {}, "sub-voxel erosion, gradient"},
          {subvoxel, words, "sub-voxel erosion, gradient, words and leaps published"},
          {subvoxel, records(RecordPrecision::bits16), "sub-voxel erosion, gradient, records of 16 bits published"}};
}

/// Times a complete simulation step. Erosion by points or table: the first step of a tool in undrilled bone. Sub-voxel erosion: the second
/// step, after a feed of a twentieth of a voxel, as in drilling.
Status measure_whole_step(Bench& bench, BuriedBurr& bone, double spin, const StepCase& c) {
  std::optional<Erosion> erosion;
  const auto make = [&]() -> Status {
    auto made = Erosion::create(c.erosion, bone.burr.erosion, bone.burr.cutting);
    if (!made) return made.error();
    erosion.emplace(std::move(made).value());
    return {};
  };
  if (Status made = make(); !made) return made;
  ContactWindowPublisher publisher(*bone.voxmap, c.publishing.value_or(ContactFields{.density = true, .gradient = false}));
  const VoxelBox box = bone.voxmap->window().erodible_box();
  Affine on = bone.index_from_tool;
  on.offset += 0.05 * glm::normalize(on.linear * Vec3(0.0, 0.0, -1.0));
  const ErosionPath rest{bone.index_from_tool, bone.index_from_tool}, way{bone.index_from_tool, on};
  const auto put_back = [&] {
    bone.put_back();
    bone.voxmap->commit(box);
    if (c.erosion.subvoxel) {
      (void)make();  // cannot fail: it succeeded before
      bone.voxmap->commit(erosion->step(*bone.voxmap, rest, spin, kDt).changed);
    }
    for (int n = 0; n < 3; ++n) {  // brings all three copies up to date, as a reader at full rate does
      publisher.publish(*bone.voxmap);
      (void)publisher.exchange().latest();
    }
  };
  std::uint32_t touched = 0;
  const Side step{put_back, [&] {
                    const ErosionOutcome outcome = erosion->step(*bone.voxmap, c.erosion.subvoxel ? way : rest, spin, kDt);
                    bone.voxmap->commit(outcome.changed);
                    if (c.publishing) publisher.publish(*bone.voxmap);
                    touched = outcome.touched;
                  }};
  const Medians medians = bench.time({put_back, [] {}}, step);
  const std::string name = fmt::format("whole step of {} points: {}", bone.burr.erosion.size(), c.what);
  if (bench.require(name, touched > 0, "nothing was eroded")) bench.add_absolute(name, "kHz", 1e-3 / medians.value, false, {1.0, 8.0});
  bone.put_back();
  bone.voxmap->commit(box);
  return {};
}

/// Sets `remaining` in the box to random values, so that no gradient can be skipped as one of uniform bone.
void roughen(Voxmap& voxmap, const VoxelBox& box, std::uint64_t seed) {
  const MasterWindow& window = voxmap.window();
  const std::span<float> remaining = voxmap.remaining();
  for_each_voxel(box, [&](const Vec3i& v) {
    const std::size_t at = window.box.offset_of(v);
    remaining[at] = static_cast<float>(uniform01(seed, at));
  });
}

/// @returns whether words are within the rounding error of the floats: density half a step of 1/255 (a whole step for the smallest value,
/// which is never rounded to 0), gradient components half a step of 1/254, plus the rounding of a float.
bool within_steps(std::span<const float> density, std::span<const Vec3f> gradient, std::span<const ContactWord> words, const VoxelBox& box,
                  const VoxelBox& compared) {
  bool all = true;
  for_each_voxel(compared, [&](const Vec3i& v) {
    const std::size_t at = box.offset_of(v);
    const auto byte = [&](int n) { return static_cast<std::int8_t>((words[at] >> (8 * n)) & 0xFFu); };
    const int filled = static_cast<int>(words[at] & 0xFFu);
    const bool zero = byte(3) == -128;
    all = all && std::abs(filled / 255.0 - static_cast<double>(density[at])) <= (filled == 1 ? 1.0 : 0.5) / 255.0 + 1e-6;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double part = zero ? 0.0 : byte(static_cast<int>(axis) + 1) / 254.0;
      all = all && std::abs(part - static_cast<double>(gradient[at][axis])) <= 0.5 / 254.0 + 1e-6;
    }
  });
  return all;
}

/// Times density and gradient in the form that contact reads: packed words, and floats. The baseline writes the paper's grids.
void compare_commit(Bench& bench, Voxmap& voxmap, const Vec3i& centre, int edge, const Bars& bars) {
  const VoxelBox box{centre - edge / 2, centre + edge / 2}, halo = box.grown(1);
  const std::string name = fmt::format("density and gradient of a box of {}^3", edge);
  roughen(voxmap, box, static_cast<std::uint64_t>(edge));
  const MasterWindow& master = voxmap.window();
  VdbGradient by_accessors(master, master.gradient_dead_zone);
  std::vector<ContactWord> words(master.box.count(), kEmptyWord);
  std::vector<std::uint8_t> sides(master.box.count(), 0);
  std::vector<Vec3f> floats(master.box.count());
  derive_gradient(master, master.box, floats);
  const Side accessors{{}, [&] { by_accessors.commit(box); }},
      packed{{},
             [&] {
               voxmap.commit(box);
               pack_words({master.box, master.density}, halo, master.gradient_dead_zone, words, sides);
             }},
      plain{{}, [&] {
              voxmap.commit(box);
              derive_gradient(master, halo, floats);
            }};
  const std::vector<float> density_before = master.density;
  packed.run();
  plain.run();
  accessors.run();
  // Both halve the difference of the same floats, so the results must be bit-identical.
  const bool changed = bench.require(name, density_before != master.density, "no density changed");
  if (!changed || !bench.agree(name, bytes_of(by_accessors.density()), bytes_of(master.density)) ||
      !bench.agree(name, bytes_of(by_accessors.gradient()), bytes_of(floats)) ||
      !bench.require(name, within_steps(by_accessors.density(), by_accessors.gradient(), words, master.box, halo),
                     "a word is more than half a step off"))
    return;
  bench.add_speed_up(name + ", packed", "us", 1e6, bench.time(accessors, packed), bars);
  bench.add_speed_up(name + ", floats", "us", 1e6, bench.time(accessors, plain));
}

Status compare_commits(Bench& bench, const BuriedBurr& bone) {
  auto voxmap = Voxmap::create(bone.loaded->bone, {});
  if (!voxmap) return voxmap.error();
  const Vec3i centre = voxel_of(bone.index_from_tool * Vec3(0.0, 0.0, 2.5e-3));
  if (Status placed = voxmap->place_window({centre - 40, centre + 40}); !placed) return placed;
  compare_commit(bench, *voxmap, centre, 20, {70.0, 180.0});
  compare_commit(bench, *voxmap, centre, 40, {});
  compare_commit(bench, *voxmap, centre, 64, {120.0, 250.0});
  return {};
}

/// Times publishing of a changed box of the shipped scene's window at the entry; the baseline copies the window.
Status compare_publish(Bench& bench, const LoadedScene& loaded) {
  auto voxmap = Voxmap::create(loaded.bone, {});
  if (!voxmap) return voxmap.error();
  const auto approach = make_approach(*loaded.bone, loaded.scene.approach);
  if (!approach) return approach.error();
  const Affine index_from_tool = loaded.bone->bone_from_index().inverse() * Affine::from_pose(approach->bone_from_approach);
  if (Status placed = voxmap->place_window(
          tool_box(loaded.tool, index_from_tool,
                   window_margins(loaded.scene.effects.needs(loaded.scene).fields, loaded.bone->bone_from_index()).placed));
      !placed)
    return placed;
  ContactWindowPublisher publisher(*voxmap);
  const MasterWindow& master = voxmap->window();
  const Vec3i tip = voxel_of(index_from_tool * Vec3(0.0));
  const VoxelBox box{tip - 10, tip + 10};
  const Vec3i size = master.box.size();
  const std::string name = fmt::format("publish a box of 20^3 of a {} x {} x {} window over copying it whole", size.x, size.y, size.z);

  std::uint64_t seed = 0;
  const auto change = [&] {
    roughen(*voxmap, box, ++seed);
    voxmap->commit(box);
  };
  ContactWindow copy;
  copy.density = master.density;
  copy.gradient.resize(master.density.size());
  const Side whole{change, [&] {
                     std::ranges::copy(master.density, copy.density.begin());
                     derive_gradient(master, master.box, copy.gradient);
                   }};
  const Side boxes{[&] {
                     (void)publisher.exchange().latest();  // a reader at full rate: all three copies are used in turn
                     change();
                   },
                   [&] { publisher.publish(*voxmap); }};
  for (int n = 0; n < 6; ++n) {  // each copy is written completely once and updated once
    boxes.prepare();
    boxes.run();
  }
  const auto same = [&] {
    const ContactWindow& latest = publisher.exchange().latest();
    whole.run();
    return bench.agree(name, bytes_of(copy.density), bytes_of(latest.density)) &&
           bench.agree(name, bytes_of(copy.gradient), bytes_of(latest.gradient));
  };
  if (!same()) return {};
  const Medians medians = bench.time(whole, boxes);
  boxes.prepare();
  boxes.run();
  if (same()) bench.add_speed_up(name, "us", 1e6, medians);
  return {};
}

}  // namespace

Status bench_erosion(Bench& bench) {
  auto bone = bury_burr();
  if (!bone) return bone.error();
  const double spin = bone->loaded->scene.tool.spin;
  // The targets of the lattice order were set with an accessor that visits the points in Morton order; rows of the lattice use its cached
  // leaf as well. The window sorts the points into the tool's lattice in both cases.
  const Bars random{15.0, 28.0}, ordered{9.0, 16.0};
  for (const bool random_order : {true, false}) {
    const Bars& bars = random_order ? random : ordered;
    // e s of eq. 4 is small enough that every voxel still has bone when its last point is applied.
    for (const LawCase& c :
         {LawCase{ErosionLaw::rate, spin, random_order, bars}, LawCase{ErosionLaw::per_update, 0.025, random_order, bars}})
      if (Status done = compare_laws(bench, *bone, c); !done) return done;
  }
  if (Status done = compare_forms(bench, *bone, spin); !done) return done;
  compare_exposures(bench, *bone);
  for (const StepCase& c : step_cases())
    if (Status done = measure_whole_step(bench, *bone, spin, c); !done) return done;
  if (Status done = compare_commits(bench, *bone); !done) return done;
  return compare_publish(bench, *bone->loaded);
}

}  // namespace burrhole
