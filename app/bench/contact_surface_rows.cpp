// Rows of contact between the points of the shell: ticks of shipped bits that slide over the shipped bone at spin 0. The baseline is the
// same tool with its points alone, as it was before its surface was followed.
#include <fmt/format.h>

#include "app/bench/bench_scene.h"
#include "app/bench/contact_bones.h"
#include "core/base/units.h"
#include "core/contact/constrained_tool.h"

namespace burrhole {
namespace {

constexpr double kPeriod = 1e-3;                      // [s]
constexpr int kPress = 150, kTicks = 64;              // ticks before and during the measurement
constexpr double kDeep = 5.6e-3, kAbove = 1e-3;       // [m] of the hand: 28 N on the coupling of 5000 N/m; at the start
constexpr double kSlide = 20e-3;                      // [m/s]
constexpr double kLeastForce = 5.0;                   // [N]
constexpr Bars kBars{.ship = 1.0 / 1.3, .aim = 1.0};  // a tick takes at most 1.3 times that of the points
constexpr double kLeans[] = {0.0, 20.0 * kDegree};    // [rad]

/// The hand's way: the tool is pressed onto bone, not timed, and then moved along it.
struct Way {
  Pose start, entry;
  std::vector<HandMotion> press, slide;
};

/// @param lean [rad] of the shaft, about the entry.
Way way_of(const Pose& world_from_approach, double lean) {
  const Quat leaning = glm::angleAxis(lean, Vec3(0.0, 1.0, 0.0));
  const auto at = [&](double x, double z) { return world_from_approach * Pose{leaning, Vec3(x, 0.0, z)}; };
  Way out{at(0.0, kAbove), at(0.0, 0.0), {}, {}};
  for (int n = 1; n <= kPress; ++n) out.press.push_back({at(0.0, kAbove - std::min(1.0, 1.5 * n / kPress) * (kAbove + kDeep)), Vec3(0.0)});
  for (int n = 0; n < kTicks; ++n) out.slide.push_back({at(kSlide * kPeriod * n, -kDeep), Vec3(0.0)});
  return out;
}

struct SlidingTool {
  ConstrainedTool tool;
  Way way;

  void begin(const SurfaceView& bone) {
    tool.place(way.start);
    for (const HandMotion& motion : way.press) (void)tool.step(bone, motion, kPeriod, {.spinning = false});
  }
  template <class F>
  void run(const SurfaceView& bone, F&& receive) {
    for (const HandMotion& motion : way.slide) receive(tool.step(bone, motion, kPeriod, {.spinning = false}));
  }
  [[nodiscard]] Side side(const SurfaceView& bone) {
    return {[this, bone] { begin(bone); }, [this, bone] { run(bone, [](const ConstrainedToolState&) {}); }};
  }
};

struct SlideResults {
  std::vector<double> numbers;  // [m], [N] per tick: position of the tool, force on the hand
  double least_force = 1e300;   // [N]
  std::uint32_t flags = 0;
};

SlideResults slide_along(SlidingTool& moved, const SurfaceView& bone) {
  SlideResults out;
  moved.begin(bone);
  moved.run(bone, [&](const ConstrainedToolState& state) {
    const Vec3 &p = state.world_from_tool.translation, &f = state.on_hand.force;
    out.numbers.insert(out.numbers.end(), {p.x, p.y, p.z, f.x, f.y, f.z});
    out.flags |= state.flags;
    out.least_force = std::min(out.least_force, glm::length(f));
  });
  return out;
}

Status compare_slides(Bench& bench, const LoadedScene& loaded, const std::string& bit, double lean) {
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, {}, issues);
  if (!simulation) return issues.front();
  const Way way = way_of(simulation->stage().world_from_approach(), lean);
  if (Status placed = simulation->stage().place(way.entry); !placed) return placed.error();
  const BoneForms bone(std::move(simulation->voxmap()));
  const SurfaceView view = bone.surface_view(RecordPrecision::bits16, loaded.scene.volume.world_from_bone);
  const auto make = [&](std::shared_ptr<const ToolSurface> surface) {
    return ConstrainedTool::create(*loaded.scene.find<ConstrainedToolConfig>(), loaded.tool.shell,
                                   loaded.bone->bone_from_index().mean_edge(), {.cutting = loaded.tool.cutting, .surface = surface});
  };
  auto points = make(nullptr), surface = make(loaded.tool.surface);
  if (!points) return points.error();
  if (!surface) return surface.error();
  SlidingTool by_points{std::move(*points), way}, by_surface{std::move(*surface), way};
  const std::string name =
      fmt::format("{}, {} points, leaning {:.0f} degrees at spin 0: tick with the surface between points over points alone", bit,
                  loaded.tool.shell.size(), lean / kDegree);
  const SlideResults along = slide_along(by_surface, view), other = slide_along(by_points, view);
  const double least = std::min(along.least_force, other.least_force);
  if (!levels_agree(bench, name, along, [&] { return slide_along(by_surface, view); }) ||
      !bench.require(name, along.flags == 0 && other.flags == 0, "the tool leaves the window") ||
      !bench.require(name, least > kLeastForce, fmt::format("the contact force is only {} N", least)))
    return {};
  bench.add_speed_up(name, "us/tick", 1e6 / kTicks, bench.time(by_points.side(view), by_surface.side(view)), kBars);
  return {};
}

}  // namespace

Status bench_surface_contact(Bench& bench) {
  for (const char* bit : {"round_burr_6mm", "acorn_burr_7_5mm", "perforator_14_11", "twist_drill_2_5mm", "matchstick_burr_3mm"}) {
    auto loaded = load_parietal_scene({fmt::format("tool.name=\"{}\"", bit)});
    if (!loaded) return loaded.error();
    for (const double lean : kLeans)
      if (Status done = compare_slides(bench, **loaded, bit, lean); !done) return done;
  }
  return {};
}

}  // namespace burrhole
