// Rows of the constrained tool of contact model `surface`: complete ticks. The baseline is a penalty evaluation of gradient-plane in the
// paper's storage.
#include <fmt/format.h>

#include "app/bench/bench_scene.h"
#include "app/bench/contact_bones.h"
#include "core/contact/constrained_tool.h"

namespace burrhole {
namespace {

constexpr std::size_t kTicks = 32, kWarmUp = 16;

/// A constrained tool and hand motions for it. The first motions bring it to rest on bone and are not timed.
struct MovedTool {
  ConstrainedTool tool;
  Pose start;
  std::vector<HandMotion> warm_up, motions;
  double dt = 1e-3;  // [s]
  bool spinning = true;

  void begin(const SurfaceView& bone) {
    tool.place(start);
    for (const HandMotion& motion : warm_up) (void)tool.step(bone, motion, dt, {.spinning = spinning});
  }
  template <class F>
  void run(const SurfaceView& bone, F&& receive) {
    for (const HandMotion& motion : motions) receive(tool.step(bone, motion, dt, {.spinning = spinning}));
  }
  [[nodiscard]] Side side(const SurfaceView& bone) {
    return {[this, bone] { begin(bone); }, [this, bone] { run(bone, [](const ConstrainedToolState&) {}); }};
  }
};

/// Results of the timed motions, per tick.
struct TickResults {
  std::vector<double> numbers;
  std::vector<Pose> poses;
  std::vector<Vec3> forces;    // [N]
  double least_force = 1e300;  // [N]
  double moves = 0.0;          // mean number of moves in a tick
};

void append(std::vector<double>& out, const Vec3& v) { out.insert(out.end(), {v.x, v.y, v.z}); }

TickResults run_ticks(MovedTool& moved, const SurfaceView& bone) {
  TickResults out;
  moved.begin(bone);
  moved.run(bone, [&](const ConstrainedToolState& state) {
    append(out.numbers, state.world_from_tool.translation);
    append(out.numbers, state.on_hand.force);
    append(out.numbers, state.on_hand.torque);
    out.numbers.push_back(state.engagement);
    out.numbers.push_back(static_cast<double>(state.flags));
    out.poses.push_back(state.world_from_tool);
    out.forces.push_back(state.on_hand.force);
    out.least_force = std::min(out.least_force, glm::length(state.on_hand.force));
    out.moves += static_cast<double>(state.moves) / static_cast<double>(moved.motions.size());
  });
  return out;
}

// A distance of 8 bits has an error of up to 1/64 voxel and a normal of up to 1/254. A few planes among many constrain the tool, and
// another choice among them moves it by a few such steps. The forces differ by the coupling's stiffness and the tilt of the normals.
constexpr double kPlaceDifference = 0.1;  // [voxel edges]
constexpr double kForceDifference = 0.1;  // of the largest force

bool precisions_agree(Bench& bench, const std::string& name, const TickResults& bits8, const TickResults& bits16, double edge) {
  double place = 0.0, force = 0.0, most = 0.0;
  for (std::size_t n = 0; n < bits8.poses.size(); ++n) {
    place = std::max(place, glm::length(bits8.poses[n].translation - bits16.poses[n].translation) / edge);
    force = std::max(force, glm::length(bits8.forces[n] - bits16.forces[n]));
    most = std::max(most, glm::length(bits16.forces[n]));
  }
  return bench.require(name, place < kPlaceDifference && force < kForceDifference * most,
                       fmt::format("records of 8 and 16 bits differ by {} voxels in the pose and by {} of the force", place, force / most));
}

struct TickRows {
  std::string what;
  Bars bars;
  bool by_point = false;      ///< unit ns per point instead of us per tick
  bool count_points = false;  ///< adds a row with the number of points that fit into a period
  double least_force = 1.0;   ///< [N] below which the tool counts as free
};

/// Times ticks on records of both precisions; the baseline evaluates the paper's model once at the pose of the constrained tool.
Status compare_ticks(Bench& bench, const TickRows& rows, MovedTool& moved, const BoneForms& bone, const Pose& world_from_bone) {
  const PointShell& shell = moved.tool.shell();
  const auto model = GradientPlane::create({.paper_mode = true}, shell);
  if (!model) return model.error();
  const auto name_of_row = [&](int bits) {
    return fmt::format("{}, {} points: surface tick on records of {} bits over penalty evaluation in the paper's storage", rows.what,
                       shell.size(), bits);
  };
  const SurfaceView small = bone.surface_view(RecordPrecision::bits8, world_from_bone),
                    large = bone.surface_view(RecordPrecision::bits16, world_from_bone);
  const TickResults by_small = run_ticks(moved, small), by_large = run_ticks(moved, large);
  const bool small_agrees = levels_agree(bench, name_of_row(8), by_small, [&] { return run_ticks(moved, small); });
  const bool large_agrees = levels_agree(bench, name_of_row(16), by_large, [&] { return run_ticks(moved, large); });
  const bool constrained = bench.require(name_of_row(16), by_large.least_force > rows.least_force,
                                         fmt::format("the contact force is only {} N", by_large.least_force));
  const double edge = bone.voxmap->bone().bone_from_index().mean_edge();
  if (!small_agrees || !large_agrees || !constrained || !precisions_agree(bench, name_of_row(8), by_small, by_large, edge)) return {};

  const ContactView grids = bone.grid_view(world_from_bone);
  const std::size_t touching = evaluate_poses(**model, grids, by_large.poses).contacts;
  if (!bench.require(name_of_row(16), touching > 0, "no point touches in the baseline")) return {};
  ContactResult scratch;
  scratch.contacts.reserve(shell.size());
  const Side penalty = evaluate_all(**model, grids, by_large.poses, scratch);
  const auto ticks = static_cast<double>(moved.motions.size()), points = static_cast<double>(shell.size());
  const double per_unit = rows.by_point ? 1e9 / (ticks * points) : 1e6 / ticks;
  const std::string unit = rows.by_point ? "ns/point" : "us/tick";
  const Medians medians8 = bench.time(penalty, moved.side(small)), medians16 = bench.time(penalty, moved.side(large));
  bench.add_speed_up(name_of_row(16), unit, per_unit, medians16, rows.bars);
  bench.add_speed_up(name_of_row(8), unit, per_unit, medians8, rows.bars);
  bench.add_absolute(fmt::format("{}, {} points: moves a surface tick", rows.what, shell.size()), "moves", by_large.moves, true);
  bench.add_absolute(fmt::format("{}, {} points: share that touches in the baseline", rows.what, shell.size()), "1",
                     static_cast<double>(touching) / (ticks * points), false);
  if (rows.count_points)
    for (const auto& [bits, medians] : {std::pair{8, medians8}, std::pair{16, medians16}})
      bench.add_absolute(fmt::format("surface: points in 0.9 ms, of a shell of {}, records of {} bits", shell.size(), bits), "points",
                         0.9e-3 * points * ticks / medians.value, false, {50'000.0, 110'000.0});
  return {};
}

/// @returns motions round the socket, pressed against its wall and rotated.
std::vector<HandMotion> circle(std::size_t count, double first_angle) {
  std::vector<HandMotion> out;
  for (std::size_t n = 0; n < count; ++n) {
    const double angle = first_angle + 0.02 * static_cast<double>(n);
    const Vec3 way(std::cos(angle), std::sin(angle), 0.4 * std::sin(0.7 * angle));
    const Quat turn = glm::angleAxis(0.3 * angle, glm::normalize(Vec3(0.3, 0.5, 0.8)));
    out.push_back({{turn, 0.8e-3 * way}, Vec3(0.0)});
  }
  return out;
}

Status compare_balls(Bench& bench) {
  auto bone = make_socket();
  if (!bone) return bone.error();
  for (const BallSize& size : {BallSize{23, 50, 729}, BallSize{66, 138, 5800}, BallSize{214, 367, 50'000}}) {
    const auto shell = make_ball(size.stacks, size.slices, size.points);
    if (!shell) return shell.error();
    // Without spin the normal of each plane depends on all points close to the surface, here on all points (conforming_normal.h).
    for (const bool spinning : {true, false}) {
      if (!spinning && size.points == 50'000) continue;
      auto tool = ConstrainedTool::create({}, shell.value(), kBenchEdge);
      if (!tool) return tool.error();
      const double warm_up_ends = 0.02 * static_cast<double>(kWarmUp);
      MovedTool moved{std::move(tool).value(), {}, circle(kWarmUp, 0.0), circle(kTicks, warm_up_ends), 1e-3, spinning};
      const TickRows rows{.what = spinning ? "ball all near the surface" : "ball all near the surface, at spin 0",
                          .bars = spinning ? Bars{15.0, 30.0} : Bars{},
                          .by_point = true,
                          .count_points = size.points == 50'000};
      if (Status done = compare_ticks(bench, rows, moved, bone.value(), {}); !done) return done;
    }
  }
  return {};
}

/// Times the penalty model on packed words at the same poses; the baseline is the paper's storage.
Status compare_penalty(Bench& bench, const std::string& what, const PointShell& shell, const BoneForms& bone, const Pose& world_from_bone,
                       const std::vector<Pose>& poses) {
  const auto model = GradientPlane::create({.paper_mode = true}, shell);
  if (!model) return model.error();
  const std::string name = fmt::format("{}, {} points: penalty evaluation, words over paper's storage", what, shell.size());
  const ContactView words = bone.word_view(world_from_bone), grids = bone.grid_view(world_from_bone);
  const auto run_words = [&] { return evaluate_poses(**model, words, poses); };
  if (!levels_agree(bench, name, run_words(), run_words)) return {};
  ContactResult scratch;
  scratch.contacts.reserve(shell.size());
  bench.add_speed_up(name, "us", 1e6 / static_cast<double>(poses.size()),
                     bench.time(evaluate_all(**model, grids, poses, scratch), evaluate_all(**model, words, poses, scratch)));
  return {};
}

/// Times further simulation steps: erosion by sub-voxels, gradients, publishing of records.
void measure_bone_steps(Bench& bench, Simulation& simulation, const Scene& scene, const std::string& what) {
  BoneStep& step = simulation.bone_step();
  Pose pose = simulation.contact_state().world_from_tool;
  const double dt = 1.0 / scene.effects.needs(scene).simulation_hz;
  ContactState found;
  const Vec3 down = pose.rotate(Vec3(0.0, 0.0, -0.2e-3 * dt));  // the feed of the shipped scene
  const Side steps{[&] { pose.translation += down; },
                   [&] {
                     found.world_from_tool = pose;
                     step(found, 28.0, dt);
                   }};
  const Medians medians = bench.time(steps, steps);
  bench.add_absolute(what + ": bone step (sub-voxel erosion, gradients, publishing records)", "us", 1e6 * medians.value, true);
}

}  // namespace

Status bench_constrained_tool(Bench& bench) {
  if (Status done = compare_balls(bench); !done) return done;
  auto drilled = drill_parietal_half_way(bench.quick());
  if (!drilled) return drilled.error();
  const LoadedScene& loaded = *drilled->loaded;
  const Scene& scene = loaded.scene;
  auto tool = ConstrainedTool::create(*scene.find<ConstrainedToolConfig>(), loaded.tool.shell, loaded.bone->bone_from_index().mean_edge(),
                                      {.cutting = loaded.tool.cutting, .surface = loaded.tool.surface});
  if (!tool) return tool.error();
  const std::vector<HandState>& all = drilled->hand->states();
  std::vector<HandMotion> motions;
  for (const HandState& state : std::span(all).last(std::min(kTicks + kWarmUp, all.size()))) motions.push_back(state);
  const auto timed = motions.begin() + static_cast<std::ptrdiff_t>(motions.size() - std::min(kTicks, motions.size()));
  MovedTool moved{std::move(tool).value(), drilled->simulation->contact_state().world_from_tool, {motions.begin(), timed},
                  {timed, motions.end()},  1.0 / scene.effects.needs(scene).contact_hz,          scene.tool.spin > 0.0};
  const std::string what = "14/11 perforator half way";
  measure_bone_steps(bench, *drilled->simulation, scene, what);
  const BoneForms bone(std::move(drilled->simulation->voxmap()));
  const Pose& world_from_bone = scene.volume.world_from_bone;
  const std::vector<Pose> poses = run_ticks(moved, bone.surface_view(RecordPrecision::bits16, world_from_bone)).poses;
  if (Status done = compare_penalty(bench, what, loaded.tool.shell, bone, world_from_bone, poses); !done) return done;
  return compare_ticks(bench, {.what = what, .bars = {}}, moved, bone, world_from_bone);
}

}  // namespace burrhole
