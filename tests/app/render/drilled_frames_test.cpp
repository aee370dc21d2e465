// A whole drilled scene through the frame step of the program, a picture every 25 ms: kept pictures against whole ones.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "app/view/display_config.h"
#include "app/view/texels.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/drill_scene.h"
#include "tests/support/image_compare.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kTicksPerFrame = 25;

/// One way to draw, by a renderer that keeps its pictures and one that does not.
struct Way {
  std::string name;
  RenderOptions options;
  bool tool = true, cut = false;
  std::unique_ptr<Renderer> kept{}, whole{};
  Image last{};
};

/// Feeds all ways alike and compares each picture.
class ComparingSink final : public FrameSink {
 public:
  explicit ComparingSink(std::vector<Way> chosen) : ways(std::move(chosen)) {
    for (Way& way : ways) {
      way.options.growth_is_reported = true;  // as in the program
      way.kept = std::make_unique<Renderer>(require_renderer(way.options));
      way.options.keep_picture = way.options.growth_is_reported = false;
      way.whole = std::make_unique<Renderer>(require_renderer(way.options));
    }
  }
  Status start(const VolumeView& volume, const TriangleMesh& tool) override {
    for (Way& way : ways)
      for (Renderer* one : {way.kept.get(), way.whole.get()}) {
        if (Status set = one->set_volume(volume); !set) return set;
        if (Status set = one->set_tool(tool); !set) return set;
      }
    return {};
  }
  void update(const TexelBox& texels) override {
    ++boxes;
    sent += texels.box.count();
    for (Way& way : ways)
      for (Renderer* one : {way.kept.get(), way.whole.get()}) one->update(texels);
  }
  Status move_detail(const DetailView& view) override {
    for (Way& way : ways)
      for (Renderer* one : {way.kept.get(), way.whole.get()})
        if (Status set = one->set_detail(view); !set) return set;
    return {};
  }
  Status set_added(const std::shared_ptr<const AddedMesh>& mesh) override {
    ++added;
    triangles = mesh == nullptr ? 0 : mesh->triangles.size();
    if (added == 1) first_triangles = triangles;
    for (Way& way : ways)
      for (Renderer* one : {way.kept.get(), way.whole.get()})
        if (Status set = one->set_added(mesh); !set) return set;
    return {};
  }
  void forget() override {
    ++forgotten;
    for (Way& way : ways) way.kept->forget();
  }
  Status draw(const std::string& name, const FrameView& asked, int width, int height, Hash64&) override {
    ++pictures;
    largest_parcel = std::max(largest_parcel, std::exchange(sent, 0));
    for (Way& way : ways) {
      FrameView view = asked;
      if (!way.tool) view.world_from_tool.reset();
      if (way.cut) view.cut = FrameView::Cut{{0, -1, 0}, 0.0};
      auto by_parts = way.kept->draw(view, width, height);
      auto at_once = way.whole->draw(view, width, height);
      if (!by_parts) return by_parts.error();
      if (!at_once) return at_once.error();
      CHECK(pictures_agree("drilled-" + way.name + "-" + name, *by_parts, *at_once, {}));
      if (way.last.pixels != at_once->pixels) ++changed;
      way.last = std::move(*at_once);
    }
    return {};
  }

  std::vector<Way> ways;
  int boxes = 0, forgotten = 0, pictures = 0, changed = 0, added = 0;
  std::size_t triangles = 0;                 ///< of what effects add
  std::size_t first_triangles = 0;           ///< when it was first set
  std::size_t sent = 0, largest_parcel = 0;  ///< [texels]
};

std::vector<Way> all_ways() {
  const TransferFunction haze{{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 600.0}};
  std::vector<Way> ways;
  ways.push_back({.name = "rays", .options = {.finish = false}});
  ways.push_back({.name = "rays-smooth-bare", .options = {.finish = false, .supersample = 2}, .tool = false});
  ways.push_back({.name = "shipped", .options = {.appearance = {.tissue = true, .occlusion = true}, .supersample = 2}});
  ways.push_back(
      {.name = "all-cut", .options = {.appearance = {.tissue = true, .occlusion = true, .shadow = true, .specular = true}}, .cut = true});
  ways.push_back({.name = "slices", .options = {.slices = SliceOptions{}}});
  ways.push_back({.name = "slices-smooth-bare", .options = {.supersample = 2, .slices = SliceOptions{}}, .tool = false});
  ways.push_back({.name = "mesh", .options = {.appearance = {.specular = true}, .supersample = 2, .mesh = true}});
  ways.push_back({.name = "mesh-cut-bare", .options = {.mesh = true}, .tool = false, .cut = true});
  ways.push_back({.name = "translucent-smooth", .options = {.supersample = 2, .translucent = haze}});
  ways.push_back({.name = "translucent-bare", .options = {.translucent = haze}, .tool = false});
  return ways;
}

std::vector<Way> plain_rays(const std::string& name) {
  std::vector<Way> ways;
  ways.push_back({.name = name, .options = {.finish = false}});
  return ways;
}

/// The bone as it is now, sent in one piece, with the tool.
Image drawn_afresh(DrillRun& run, const RenderOptions& options) {
  Simulation& simulation = run.simulation();
  Renderer fresh = require_renderer(options);
  REQUIRE(fresh.set_volume(make_volume_view(simulation.voxmap())).ok());
  REQUIRE(fresh.set_tool(run.loaded().tool.look).ok());
  const Scene& scene = run.loaded().scene;
  FrameView view =
      make_frame_view(*scene.find<DisplayConfig>(), scene.volume.world_from_bone,
                      scene.volume.world_from_bone * simulation.approach().bone_from_approach, simulation.approach().thickness, false);
  view.world_from_tool = simulation.contact_state().world_from_tool;
  auto picture = fresh.draw(view, scene.find<DisplayConfig>()->width, scene.find<DisplayConfig>()->height);
  REQUIRE(picture.ok());
  return std::move(*picture);
}

/// A run with a picture every 25 ms, then a checkpoint restored. @param sets of the display. @param after called at the end.
void check_kept_pictures(std::vector<Way> ways, const std::vector<std::string>& sets,
                         const std::function<void(DrillRun&, const ComparingSink&)>& after = {}) {
  ComparingSink sink(std::move(ways));
  std::vector<std::string> all_sets{"duration_s=1.2", "display.size=[120,90]"};
  all_sets.insert(all_sets.end(), sets.begin(), sets.end());
  const LoadedScene loaded = load_small({.display = true, .sets = all_sets});
  const TemporaryFolder folder;
  const std::string checkpoint = folder.file("half.vdb");
  DrillRun* running = nullptr;
  int tick = 0;
  WatchedHand hand(loaded, [&] {
    Simulation& simulation = running->simulation();
    if (++tick == 700) REQUIRE(simulation.voxmap().save(checkpoint).ok());
    if (tick % kTicksPerFrame != 0) return;
    simulation.frame_step()->gather();
    REQUIRE(simulation.frame_step()->draw("tick", simulation.contact_state().world_from_tool, false).ok());
  });
  SimulationOptions options;
  options.sink = &sink;
  options.hand = &hand;
  DrillRun run(loaded, options);
  running = &run;
  run.run();
  CHECK(sink.pictures > 40);
  CHECK(sink.boxes > 20);
  CHECK(sink.changed > 100);  // bone is removed
  CHECK(sink.forgotten == 0);

  // Bone grows back: the frame step notices by itself.
  Simulation& simulation = run.simulation();
  const std::uint64_t drilled = simulation.voxmap().hash();
  REQUIRE(simulation.voxmap().restore(checkpoint).ok());
  REQUIRE(simulation.voxmap().hash() != drilled);
  simulation.frame_step()->gather();
  REQUIRE(simulation.frame_step()->draw("restored", simulation.contact_state().world_from_tool, false).ok());
  CHECK(sink.forgotten == 1);

  const auto all = static_cast<std::uint64_t>(sink.pictures) * 120u * 90u;
  for (Way& way : sink.ways) {
    CAPTURE(way.name);
    const std::uint64_t drawn = way.kept->counters().drawn_pixels;
    MESSAGE(way.name << ": " << drawn << " of " << all << " pixels");
    CHECK(drawn > 0);
    CHECK(drawn < all);
    CHECK(way.whole->counters().drawn_pixels == all);
    CHECK(way.kept->counters().update_bytes == way.whole->counters().update_bytes);
  }
  if (after) after(run, sink);
}

}  // namespace

TEST_CASE("drilled frames: kept pictures are whole ones over a run and after a restored checkpoint, by fewer pixels") {
  check_kept_pictures(all_ways(), {}, [](DrillRun& run, const ComparingSink& sink) {
    CHECK(pictures_agree("drilled-fresh", sink.ways[0].last, drawn_afresh(run, sink.ways[0].options), {}));
  });
}

TEST_CASE("drilled frames: the same for a bone in two levels") {
  std::vector<Way> ways = all_ways();
  for (Way& way : ways) way.name += "-two-levels";
  check_kept_pictures(std::move(ways), {"display.whole_voxels=4000", "display.detail_mm=4.4"});
}

TEST_CASE(
    "drilled frames: a dura that is indented and torn: kept pictures are whole ones, and after a reset it is whole; absent, nothing is "
    "added") {
  const auto run_with = [](const std::string& dura, auto&& look) {
    std::vector<Way> ways;
    ways.push_back({.name = "dura", .options = {.appearance = {.tissue = true, .occlusion = true}}});
    ways.push_back({.name = "dura-cut", .options = {.finish = false, .supersample = 2}, .cut = true});
    ways.push_back({.name = "dura-mesh", .options = {.mesh = true}, .tool = false});
    ways.push_back({.name = "dura-slices", .options = {.slices = SliceOptions{}}});
    ComparingSink sink(std::move(ways));
    const SmallScene scene{.volume = kInnerTableKeys,
                           .display = true,
                           .sets = {"duration_s=5.0", "tool.erosion_scale=5", "volume.extent_mm=[14.0, 14.0, 8.0]", "volume.spacing_mm=0.5",
                                    "volume.dura_mm=1.0", "volume.thickness_mm=2.5", "volume.inner_table_mm=2.5", "display.size=[120,90]",
                                    "hand.reaction_ms=600"}};
    const LoadedScene loaded = load_text(scene_text(scene) + dura, scene.sets);
    DrillRun* running = nullptr;
    int tick = 0;
    WatchedHand hand(loaded, [&] {
      if (++tick % 100 != 0) return;
      Simulation& simulation = running->simulation();
      simulation.stage().gather(true);
      REQUIRE(simulation.stage().draw("tick", simulation.contact_state().world_from_tool, false).ok());
    });
    DrillRun run(loaded, {.sink = &sink, .hand = &hand, .history = true});
    running = &run;
    run.run();
    look(run, sink);
  };
  run_with("[dura]\nradius_mm = 5\nspacing_mm = 0.6\nstrain_limit = 0.02\n", [](DrillRun& run, ComparingSink& sink) {
    CHECK(figure(run.simulation(), "dura", "torn_edges") > 0.0);
    CHECK(sink.added > 3);
    const std::size_t torn = sink.triangles;
    CHECK(torn != sink.first_triangles);
    REQUIRE(run.simulation().stage().reset());
    run.simulation().stage().gather(true);
    REQUIRE(run.simulation().stage().draw("reset", {}, false).ok());
    CHECK(sink.triangles == sink.first_triangles);
  });
  run_with("", [](DrillRun&, ComparingSink& sink) { CHECK(sink.added == 0); });
}

TEST_CASE(
    "drilled frames: bone that heat colours and saline wets: kept pictures are whole ones, through undo, reset and restore in the run") {
  std::vector<Way> ways;
  ways.push_back({.name = "heat", .options = {.appearance = {.tissue = true, .occlusion = true}}});
  ways.push_back({.name = "heat-cut", .options = {.finish = false, .supersample = 2}, .cut = true});
  ways.push_back({.name = "heat-mesh", .options = {.mesh = true}, .tool = false});
  ways.push_back({.name = "heat-slices", .options = {.slices = SliceOptions{}}});
  ComparingSink sink(std::move(ways));
  const SmallScene scene{.volume = kSkullPatchKeys,
                         .display = true,
                         .sets = {"duration_s=2.2", "tool.erosion_scale=4", "hand.standoff_mm=0.3", "display.size=[120,90]"}};
  const LoadedScene loaded = load_text(scene_text(scene) +
                                           "[heat]\n[heat.picture]\nlowest_C = 38\n[irrigation]\ndrawn = true\n"
                                           "reach_mm = 2\nflow_ml_per_min = 0.05\nalways = true\n",
                                       scene.sets);
  DrillRun* running = nullptr;
  int tick = 0;
  WatchedHand hand(loaded, [&] {
    if (++tick % 50 != 0) return;
    Simulation& simulation = running->simulation();
    simulation.stage().gather(tick % 100 == 0);  // exactly, and with what cannot be seen left out
    REQUIRE(simulation.stage().draw("tick", simulation.contact_state().world_from_tool, false).ok());
  });
  SimulationOptions options;
  options.sink = &sink;
  options.hand = &hand;
  options.history = true;
  const auto input = [](std::uint64_t at, InputKind kind, double value = 0.0) { return Input{at, kind, value, "half", {}}; };
  options.inputs = {input(600, InputKind::spin, 0.0),  input(650, InputKind::undo),        input(700, InputKind::spin, 1.0),
                    input(1200, InputKind::spin, 0.0), input(1250, InputKind::checkpoint), input(1300, InputKind::spin, 1.0),
                    input(1700, InputKind::reset),     input(1950, InputKind::restore)};
  DrillRun run(loaded, options);
  running = &run;
  run.run();
  CHECK(sink.pictures > 40);
  CHECK(sink.added > 30);
  CHECK(sink.changed > 100);
  CHECK(sink.forgotten >= 3);
}

TEST_CASE("drilled frames: a budget spreads the texels over pictures, and the last ones show all that was drilled") {
  ComparingSink sink(plain_rays("budget"));
  const LoadedScene loaded =
      load_small({.display = true, .sets = {"duration_s=1.2", "display.size=[120,90]", "display.upload_budget_kb=2"}});
  DrillRun* running = nullptr;
  int tick = 0, late = 0;
  WatchedHand hand(loaded, [&] {
    FrameStep* frame = running->simulation().frame_step();
    if (++tick % kTicksPerFrame != 0) return;
    frame->gather();
    REQUIRE(frame->draw("tick", running->simulation().contact_state().world_from_tool, false).ok());
    late += frame->texels_waiting() > 0 ? 1 : 0;
  });
  SimulationOptions options;
  options.sink = &sink;
  options.hand = &hand;
  // The parcel for the last pictures is not bound by the budget: look at those before.
  std::size_t largest = 0, sent_before_the_end = 0;
  options.progress = [&](double, const DrillProgress&) {
    largest = sink.largest_parcel;
    sent_before_the_end = running->simulation().frame_step()->texels_sent();
  };
  DrillRun run(loaded, options);
  running = &run;
  run.run();
  FrameStep& frame = *run.simulation().frame_step();
  CHECK(late > 5);
  CHECK(largest <= 2048 / kTexelBytes);  // no row is longer than that
  CHECK(largest > 270);
  CHECK(sent_before_the_end > 0);
  CHECK(frame.texels_sent() > sent_before_the_end);
  CHECK(frame.texels_waiting() == 0);
  // Never again the whole volume, not even what waited.
  CHECK(sink.largest_parcel < run.loaded().bone->bounds().count());
  REQUIRE(frame.draw("end", run.simulation().contact_state().world_from_tool, false).ok());
  const Image all = drawn_afresh(run, {.finish = false});
  CHECK(pictures_agree("drilled-budget", sink.ways[0].last, all, {}));
}

TEST_CASE("drilled frames: what a budget held back is missing from the picture until it is sent, grown bone too") {
  ComparingSink sink(plain_rays("held"));
  const LoadedScene loaded =
      load_small({.display = true, .sets = {"duration_s=1.2", "display.size=[120,90]", "display.upload_budget_kb=1"}});
  const TemporaryFolder folder;
  SimulationOptions options;
  options.sink = &sink;
  DrillRun run(loaded, options);
  Simulation& simulation = run.simulation();
  REQUIRE(simulation.voxmap().save(folder.file("whole.vdb")).ok());
  run.run();
  // Everything that was drilled is whole bone again, of which the budget lets a part through.
  REQUIRE(simulation.voxmap().restore(folder.file("whole.vdb")).ok());
  FrameStep& frame = *simulation.frame_step();
  frame.gather();
  CHECK(frame.texels_waiting() > 0);
  REQUIRE(frame.draw("part", simulation.contact_state().world_from_tool, false).ok());
  const Image all = drawn_afresh(run, {.finish = false});
  CHECK(compare_pictures(sink.ways[0].last, all, 0).differing_share > 0.0005);
  int pictures = 0;
  for (; frame.texels_waiting() > 0; ++pictures) {
    REQUIRE(pictures < 1000);
    frame.gather();
    REQUIRE(frame.draw("more", simulation.contact_state().world_from_tool, false).ok());
  }
  CHECK(pictures > 3);
  CHECK(sink.forgotten == pictures + 1);  // as long as some of what waited may have grown
  CHECK(pictures_agree("drilled-held", sink.ways[0].last, all, {}));
}

TEST_CASE("drilled frames: a budget by the clock parts what changed, and one that is long does not") {
  for (const bool tight : {true, false}) {
    ComparingSink sink(plain_rays("clock"));
    const std::string budget = std::string("display.upload_budget_ms=") + (tight ? "1e-6" : "1000");
    DrillRun run(load_small({.display = true, .sets = {"display.size=[120,90]", budget}}), {.sink = &sink});
    Voxmap& voxmap = run.simulation().voxmap();
    const VoxelBox all = run.loaded().bone->bounds();
    REQUIRE(voxmap.place_window(all.grown(4)).ok());
    voxmap.commit(all);  // nothing changed, but all of it is dirty
    FrameStep& frame = *run.simulation().frame_step();
    frame.gather();
    // However short the time is, some thousand texels are made: a run comes to its end.
    CHECK(frame.texels_waiting() < all.count());
    CHECK((frame.texels_waiting() > 0) == tight);
    frame.gather_rest();
    CHECK(frame.texels_waiting() == 0);
    REQUIRE(frame.draw("all", {}, false).ok());
    CHECK(frame.texels_sent() == all.count());
  }
}
