#include <fmt/format.h>

#include "app/bench/areas.h"
#include "app/bench/bench_scene.h"
#include "app/bench/vdb_baselines.h"
#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr double kErosionPitch = 0.0668e-3;  // [m] gives the head of the 5 mm burr about 220,000 points
constexpr double kDt = 0.01;                 // [s] the shipped scene's step

/// The shipped bone and a 5 mm burr whose head lies wholly inside it, a little tilted.
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
  if (Status placed = out.voxmap->place_window(tool_box(out.burr, out.index_from_tool, kWindowReach)); !placed) return placed.error();
  out.as_placed = out.voxmap->window().remaining;
  return out;
}

/// One step of a law on the window and by accessors, from the same bone. `spin` [rev/s], or s of eq. 4.
Status compare_laws(Bench& bench, BuriedBurr& bone, ErosionLaw law, double spin, const Bars& bars) {
  const ErosionPoints& points = bone.burr.erosion;
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
  const Vec3i size = outcome.changed.size();
  const std::string name = fmt::format("{}, {} points, {} x {} x {} voxels", law == ErosionLaw::rate ? "rate law" : "eq. 4", points.size(),
                                       size.x, size.y, size.z);
  const bool cut = bench.require(name, outcome.changed.count() > 4000 && outcome.outside == 0, "the head of the burr is not inside bone");
  if (cut && bench.agree(name, bytes_of(by_accessors.remaining()), bytes_of(bone.voxmap->window().remaining)))
    bench.add_speed_up(name, "ns/point", 1e9 / static_cast<double>(points.size()), bench.time(accessors, window), bars);
  bone.put_back();
  return {};
}

/// Erosion, gradients and publishing as the simulation does them, one after the other.
Status measure_whole_step(Bench& bench, BuriedBurr& bone, double spin) {
  auto erosion = Erosion::create({}, bone.burr.erosion);
  if (!erosion) return erosion.error();
  ContactWindowPublisher publisher(*bone.voxmap);
  const VoxelBox box = bone.voxmap->window().erodible_box();
  const Side put_back{{}, [&] {
                        bone.put_back();
                        bone.voxmap->commit(box);
                        publisher.publish(*bone.voxmap);
                      }};
  const Side step{put_back.run, [&] {
                    const ErosionOutcome outcome = erosion->step(*bone.voxmap, {bone.index_from_tool, bone.index_from_tool}, spin, kDt);
                    bone.voxmap->commit(outcome.changed);
                    publisher.publish(*bone.voxmap);
                  }};
  const Medians medians = bench.time(put_back, step);
  bench.add_absolute(fmt::format("whole step of {} points: erosion, gradient, publish", bone.burr.erosion.size()), "kHz",
                     1e-3 / medians.value, false, {1.0, 8.0});
  put_back.run();
  return {};
}

/// `remaining` drawn at random in the box: every gradient is another, none is spared by uniform bone.
void roughen(Voxmap& voxmap, const VoxelBox& box, std::uint64_t seed) {
  const MasterWindow& window = voxmap.window();
  const std::span<float> remaining = voxmap.remaining();
  for_each_voxel(box, [&](const Vec3i& v) {
    const std::size_t at = window.box.offset_of(v);
    remaining[at] = static_cast<float>(uniform01(seed, at));
  });
}

void compare_commit(Bench& bench, Voxmap& voxmap, const Vec3i& centre, int edge, const Bars& bars) {
  const VoxelBox box{centre - edge / 2, centre + edge / 2};
  const std::string name = fmt::format("density and gradient of a box of {}^3", edge);
  roughen(voxmap, box, static_cast<std::uint64_t>(edge));
  VdbGradient by_accessors(voxmap.window(), voxmap.config().gradient_dead_zone);
  const Side window{{}, [&] { voxmap.commit(box); }}, accessors{{}, [&] { by_accessors.commit(box); }};
  const std::vector<float> density_before = voxmap.window().density;
  window.run();
  accessors.run();
  // Both halve the difference of the same floats, so that not even rounding may differ.
  const bool changed = bench.require(name, density_before != voxmap.window().density, "no density changed");
  if (changed && bench.agree(name, bytes_of(by_accessors.density()), bytes_of(voxmap.window().density)) &&
      bench.agree(name, bytes_of(by_accessors.gradient()), bytes_of(voxmap.window().gradient)))
    bench.add_speed_up(name, "us", 1e6, bench.time(accessors, window), bars);
}

Status compare_commits(Bench& bench, const BuriedBurr& bone) {
  auto voxmap = Voxmap::create(bone.loaded->bone, {});
  if (!voxmap) return voxmap.error();
  const Vec3i centre = voxel_of(bone.index_from_tool * Vec3(0.0, 0.0, 2.5e-3));
  if (Status placed = voxmap->place_window({centre - 40, centre + 40}); !placed) return placed;
  compare_commit(bench, *voxmap, centre, 20, {70.0, 180.0});
  compare_commit(bench, *voxmap, centre, 64, {120.0, 250.0});
  return {};
}

/// The shipped scene's window, as placed round its perforator at the entry.
Status compare_publish(Bench& bench, const LoadedScene& loaded) {
  auto voxmap = Voxmap::create(loaded.bone, {});
  if (!voxmap) return voxmap.error();
  const auto approach = make_approach(*loaded.bone, loaded.scene.approach);
  if (!approach) return approach.error();
  const Affine index_from_tool = loaded.bone->bone_from_index().inverse() * Affine::from_pose(approach->bone_from_approach);
  if (Status placed = voxmap->place_window(tool_box(loaded.tool, index_from_tool, kWindowReach)); !placed) return placed;
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
  ContactWindow copy{master.box, master.density, master.gradient, 0, 0};
  const Side whole{change, [&] {
                     std::ranges::copy(master.density, copy.density.begin());
                     std::ranges::copy(master.gradient, copy.gradient.begin());
                   }};
  const Side boxes{[&] {
                     (void)publisher.exchange().latest();  // a reader that keeps up: all three copies go round
                     change();
                   },
                   [&] { publisher.publish(*voxmap); }};
  for (int n = 0; n < 6; ++n) {  // every copy is taken whole once and caught up once
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
  // Set against an accessor that walks the points in Morton order; the lattice's rows are as good to its cached leaf.
  const Bars exact_scatter{9.0, 16.0};
  if (Status done = compare_laws(bench, *bone, ErosionLaw::rate, spin, exact_scatter); !done) return done;
  // e s small enough that no voxel is gone before its last point has met it.
  if (Status done = compare_laws(bench, *bone, ErosionLaw::per_update, 0.05, exact_scatter); !done) return done;
  if (Status done = measure_whole_step(bench, *bone, spin); !done) return done;
  if (Status done = compare_commits(bench, *bone); !done) return done;
  return compare_publish(bench, *bone->loaded);
}

}  // namespace burrhole
