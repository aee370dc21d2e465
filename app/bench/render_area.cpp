#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

#include "app/bench/areas.h"
#include "app/bench/bench_scene.h"
#include "app/bench/render_canvas.h"
#include "app/bench/render_peer.h"
#include "app/view/display_config.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

/// A box of 20^3 voxels at the rim of the half drilled hole, in two states: as drilled, and removed.
class ChangingBox {
 public:
  ChangingBox(Voxmap& voxmap, const VoxelBox& box)
      : voxmap_(voxmap), box_(box), as_drilled_(box.count()), listener_(voxmap.add_listener()) {
    voxmap_.read_remaining(box_, as_drilled_);
  }
  void set(bool removed) {
    const std::span<float> remaining = voxmap_.remaining();
    for_each_voxel(box_,
                   [&](const Vec3i& v) { remaining[voxmap_.window().box.offset_of(v)] = removed ? 0.0f : as_drilled_[box_.offset_of(v)]; });
    voxmap_.commit(box_);
  }
  /// Passes the texels of the boxes that changed since the last call to f, as a frame does.
  template <class F>
  void send(F&& f) {
    for (const VoxelBox& dirty : voxmap_.take_dirty(listener_)) f(make_texels(voxmap_, dirty));
  }

 private:
  Voxmap& voxmap_;
  VoxelBox box_;
  std::vector<float> as_drilled_;
  std::size_t listener_;
};

/// Times a frame after a change: changed texels are uploaded, and pixels in their footprint are drawn. Baselines: all pixels are drawn; all
/// texels are uploaded.
Status compare_dirty_frame(Bench& bench, const FrameView& view, const RenderOptions& options, const std::string& how, Voxmap& voxmap,
                           const VoxelBox& box) {
  RenderOptions whole_options = options;
  whole_options.keep_picture = false;
  auto kept = Canvas::create(options, view), whole = Canvas::create(whole_options, view);
  if (!kept || !whole) return (kept ? whole : kept).error();
  ChangingBox change(voxmap, box);
  const auto send = [&](Canvas& canvas) { change.send([&](const TexelBox& texels) { canvas.renderer.update(texels); }); };
  const auto prepare = [&](Canvas& canvas) {
    return [&] {
      change.set(false);
      send(canvas);
      canvas.draw();
      change.set(true);
    };
  };
  const auto by_boxes = [&](Canvas& canvas) {
    return Side{prepare(canvas), [&] {
                  send(canvas);
                  canvas.draw();
                }};
  };
  const Side part = by_boxes(*kept), all = by_boxes(*whole);
  const Side resent{prepare(*whole), [&] {
                      whole->set_volume(make_volume_view(voxmap, options.appearance.tissue));
                      whole->draw();
                    }};
  for (Canvas* canvas : {&*kept, &*whole}) canvas->set_volume(make_volume_view(voxmap, options.appearance.tissue));
  whole->draw();
  const Image unchanged = whole->image;
  for (const Side* side : {&part, &all}) {
    side->prepare();
    side->run();
  }
  const Image drawn_whole = whole->image;
  const std::string name = fmt::format("{}: frame after a change of 20^3, its footprint over the whole picture", how);
  const bool seen = bench.require(name, unchanged.pixels != drawn_whole.pixels, "the change is not in the picture");
  if (seen && bench.agree(name, bytes_of(drawn_whole.pixels), kept->bytes())) {
    bench.add_speed_up(name, "CPU-ms", 1e3, bench.time(all, part));
    part.prepare();
    const std::uint64_t before = kept->renderer.counters().drawn_pixels;
    part.run();
    const auto drawn = static_cast<double>(kept->renderer.counters().drawn_pixels - before);
    bench.add_absolute(fmt::format("{}: pixels drawn after a change of 20^3", how), "share of all", drawn / (kCanvasSide * kCanvasSide),
                       true);
  }
  resent.prepare();
  resent.run();
  const Vec3i dims = voxmap.bone().dims();
  const std::string sent = fmt::format("{}: the same over sending all {} x {} x {} texels", how, dims.x, dims.y, dims.z);
  if (seen && bench.agree(sent, whole->bytes(), kept->bytes())) bench.add_speed_up(sent, "CPU-ms", 1e3, bench.time(resent, part));
  change.set(false);
  return kept->error ? whole->error : kept->error;
}

/// Times the upload of a box; the baseline copies its rows into an array of the size of the volume, the least work of an upload.
Status compare_uploads(Bench& bench, const FrameView& view, Voxmap& voxmap) {
  auto canvas = Canvas::create({.finish = false, .growth_is_reported = true}, view);
  if (!canvas) return canvas.error();
  VolumeView volume = make_volume_view(voxmap);
  canvas->set_volume(volume);
  const VoxelBox all{Vec3i(0), volume.dims};
  for (const int edge : {20, 40, 64}) {
    const Vec3i lo = glm::max((volume.dims - edge) / 2, Vec3i(0));
    const VoxelBox box = VoxelBox{lo, lo + edge}.intersect(all);
    const TexelBox texels = make_texels(voxmap, box);
    const auto row = static_cast<std::size_t>(box.size().x);
    const auto copy_rows = [&](const auto& from, auto& to) {
      const auto* next = from.data();
      for (int k = box.lo.z; k < box.hi.z; ++k)
        for (int j = box.lo.y; j < box.hi.y; ++j, next += row) std::memcpy(&to[all.offset_of({box.lo.x, j, k})], next, row * sizeof(*next));
    };
    const Side copied{{}, [&] {
                        copy_rows(texels.normal_opacity, volume.normal_opacity);
                        copy_rows(texels.field, volume.field);
                      }};
    const Side uploaded{{}, [&] { canvas->renderer.update(texels); }};
    const std::uint64_t before = canvas->renderer.counters().update_bytes;
    uploaded.run();
    copied.run();
    const std::string name = fmt::format("upload of a box of {}^3 over copying its rows", edge);
    // The counter must show that only the box was sent. Its texels are unchanged.
    const std::vector<std::uint64_t> expected{box.count() * kTexelBytes}, sent{canvas->renderer.counters().update_bytes - before};
    if (bench.agree(name, bytes_of(expected), bytes_of(sent))) bench.add_cost(name, "us", 1e6, bench.time(copied, uploaded), {1.5, {}});
  }
  return canvas->error;
}

/// Times the first picture of the shipped scene, wall time: reading, generating bone, compiling shaders, upload, drawing.
Status time_first_frame(Bench& bench) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto loaded = load_parietal_scene({});
  if (!loaded) return loaded.error();
  const Scene& scene = (*loaded)->scene;
  auto voxmap = Voxmap::create((*loaded)->bone, {});
  if (!voxmap) return voxmap.error();
  const auto approach = make_approach(*(*loaded)->bone, scene.approach);
  if (!approach) return approach.error();
  const FrameView view = make_frame_view(*scene.find<DisplayConfig>(), scene.volume.world_from_bone,
                                         scene.volume.world_from_bone * approach->bone_from_approach, approach->thickness, false);
  const RenderOptions options = make_render_options(scene.find<DisplayConfig>()->quality, scene.find<DisplayConfig>()->appearance);
  auto canvas = Canvas::create(options, view);
  if (!canvas) return canvas.error();
  canvas->set_volume(make_volume_view(*voxmap, options.appearance.tissue));
  const auto picture = canvas->renderer.draw(view, scene.find<DisplayConfig>()->width, scene.find<DisplayConfig>()->height);
  if (!picture) return picture.error();
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  bench.add_absolute(fmt::format("first frame of the shipped scene, {} x {}, by the clock", picture->width, picture->height), "s", seconds,
                     true, {2.0, {}});
  return canvas->error;
}

double median_of(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

/// Times pictures of a camera that turns by a degree per picture, with half the time of a whole picture as the budget; wall time.
Status time_moving_camera(Bench& bench, const VolumeView& volume, FrameView view) {
  using Clock = std::chrono::steady_clock;
  auto canvas = Canvas::create({.finish = true}, view);
  if (!canvas) return canvas.error();
  canvas->set_volume(volume);
  const auto seconds_of = [](auto&& draw) {
    const auto start = Clock::now();
    draw();
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  std::vector<double> whole, moving;
  for (int n = 0; n < 6; ++n) {
    canvas->renderer.forget();
    whole.push_back(seconds_of([&] { canvas->draw(); }));
  }
  DynamicResolution pace(0.5 * median_of(whole));
  const Vec3 from_target = view.camera.eye - view.camera.target;
  const int pictures = bench.quick() ? 4 : 60;
  for (int n = 0; n < pictures; ++n) {
    canvas->view.camera.eye = view.camera.target + glm::angleAxis(n * kDegree, view.camera.up) * from_target;
    moving.push_back(seconds_of([&] {
      if (auto image = canvas->renderer.draw_at_pace(canvas->view, kCanvasSide, kCanvasSide, pace); !image && canvas->error)
        canvas->error = image.error();
    }));
  }
  // When the camera rests, the picture must equal that of a renderer without a budget.
  const auto rested = canvas->renderer.draw_at_pace(canvas->view, kCanvasSide, kCanvasSide, pace);
  if (!rested) return rested.error();
  canvas->renderer.forget();
  canvas->draw();
  const std::string name = "camera turning, picture over its budget of half a whole one, by the clock";
  if (bench.agree(name, canvas->bytes(), bytes_of(rested->pixels))) bench.add_cost(name, "ms", 1e3, {pace.budget(), median_of(moving)});
  return canvas->error;
}

/// Compares rays on the patch of the published figures, which has about ten times the voxels of the shipped scene.
Status compare_rays_on_fine_patch(Bench& bench) {
  const auto loaded = load_parietal_scene({"volume.spacing_mm=0.1171875"});
  if (!loaded) return loaded.error();
  const LoadedScene& fine = **loaded;
  auto voxmap = Voxmap::create(fine.bone, {});
  if (!voxmap) return voxmap.error();
  const auto approach = make_approach(*fine.bone, fine.scene.approach);
  if (!approach) return approach.error();
  const FrameView view = make_frame_view(*fine.scene.find<DisplayConfig>(), fine.scene.volume.world_from_bone, approach->bone_from_approach,
                                         approach->thickness, false);
  const Vec3i dims = fine.bone->dims();
  return compare_rays(bench, make_volume_view(*voxmap), view, fmt::format("patch of {} x {} x {}", dims.x, dims.y, dims.z), {2.0, 1.0},
                      {2.3, 1.0});
}

}  // namespace

Result<Canvas> Canvas::create(const RenderOptions& options, const FrameView& view) {
  auto renderer = Renderer::create(options);
  if (!renderer) return renderer.error();
  return Canvas{std::move(renderer).value(), view, {}, {}};
}

void Canvas::draw() {
  auto drawn = renderer.draw(view, kCanvasSide, kCanvasSide);
  if (drawn)
    image = std::move(drawn).value();
  else if (error)
    error = drawn.error();
}

void Canvas::set_volume(const VolumeView& volume) {
  if (Status set = renderer.set_volume(volume); !set && error) error = set;
}

Status bench_render(Bench& bench) {
  if (Status timed = time_first_frame(bench); !timed) return timed;
  auto drilled = drill_parietal_half_way(bench.quick());
  if (!drilled) return drilled.error();
  const Scene& scene = drilled->loaded->scene;
  Voxmap& voxmap = drilled->simulation->voxmap();
  const Approach& approach = drilled->simulation->approach();
  const FrameView view = make_frame_view(*scene.find<DisplayConfig>(), scene.volume.world_from_bone,
                                         scene.volume.world_from_bone * approach.bone_from_approach, approach.thickness, false);
  // The far rim of the hole of 14 mm, whose wall is visible; deep enough for the box to lie inside the volume.
  const Vec3 rim = voxmap.bone().bone_from_index().inverse() * (approach.bone_from_approach * Vec3(0.0, 7e-3, -0.75e-3));
  const VoxelBox box{voxel_of(rim) - 10, voxel_of(rim) + 10};
  if (Status placed = voxmap.place_window(box.grown(4)); !placed) return placed;
  RenderOptions shipped = make_render_options(scene.find<DisplayConfig>()->quality, scene.find<DisplayConfig>()->appearance);
  shipped.supersample = 1;
  shipped.growth_is_reported = true;
  if (Status done = compare_dirty_frame(bench, view, shipped, "as shipped, a ray a pixel", voxmap, box); !done) return done;
  if (Status done = compare_dirty_frame(bench, view, {.finish = false, .growth_is_reported = true}, "plain", voxmap, box); !done)
    return done;
  if (Status done = compare_uploads(bench, view, voxmap); !done) return done;
  if (Status done = time_moving_camera(bench, make_volume_view(voxmap), view); !done) return done;
  if (Status done = compare_with_vtk(bench); !done) return done;
  if (bench.quick()) return compare_rays(bench, make_volume_view(voxmap), view, "shipped scene half way", {}, {});
  return compare_rays_on_fine_patch(bench);
}

}  // namespace burrhole
