#include <fmt/format.h>

#include <cstring>

#include "app/bench/areas.h"
#include "app/bench/bench_scene.h"
#include "app/bench/render_peer.h"
#include "app/engine/texels.h"
#include "app/render/renderer.h"

namespace burrhole {
namespace {

constexpr int kSide = 512;  // [pixels]
constexpr double kMega = 1e-6;

/// Sets a volume once, draws and checks; an Error ends the area.
struct Canvas {
  Renderer renderer;
  FrameView view;
  Image image;  // the last picture
  Status fault;

  void draw() {
    auto drawn = renderer.draw(view, kSide, kSide);
    if (drawn)
      image = std::move(drawn).value();
    else if (fault)
      fault = drawn.error();
  }
  void set_volume(const VolumeView& volume) {
    if (Status set = renderer.set_volume(volume); !set && fault) fault = set;
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_of(image.pixels); }
};

Result<Canvas> make_canvas(const RenderOptions& options, const FrameView& view) {
  auto renderer = Renderer::create(options);
  if (!renderer) return renderer.error();
  return Canvas{std::move(renderer).value(), view, {}, {}};
}

/// A box of 20^3 in the rim of the half drilled hole, in two states: as drilled, and gone.
class ChangingBox {
 public:
  ChangingBox(Voxmap& voxmap, const VoxelBox& box)
      : voxmap_(voxmap), box_(box), as_drilled_(box.count()), listener_(voxmap.add_listener()) {
    voxmap_.read_remaining(box_, as_drilled_);
  }
  void set(bool gone) {
    const std::span<float> remaining = voxmap_.remaining();
    for_each_voxel(box_,
                   [&](const Vec3i& v) { remaining[voxmap_.window().box.offset_of(v)] = gone ? 0.0f : as_drilled_[box_.offset_of(v)]; });
    voxmap_.commit(box_);
  }
  /// What a frame sends: texels of the boxes changed since the last call.
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

/// The change as a frame of drilling sends it, against sending all of the bone; then the box's upload alone.
void compare_dirty_frame(Bench& bench, Canvas& canvas, Voxmap& voxmap, const VoxelBox& box) {
  ChangingBox change(voxmap, box);
  const auto update = [&] { change.send([&](const TexelBox& texels) { canvas.renderer.update(texels); }); };
  const auto back_to_drilled = [&] {
    change.set(false);
    update();
    change.set(true);
  };
  const Side whole{back_to_drilled, [&] {
                     canvas.set_volume(make_volume_view(voxmap));
                     canvas.draw();
                   }};
  const Side boxes{back_to_drilled, [&] {
                     update();
                     canvas.draw();
                   }};
  canvas.set_volume(make_volume_view(voxmap));
  canvas.draw();
  const Image unchanged = canvas.image;
  boxes.prepare();
  boxes.run();
  const Image by_boxes = canvas.image;
  whole.prepare();
  whole.run();
  const Vec3i dims = voxmap.bone().dims();
  const std::string name = fmt::format("frame after a change of 20^3 over sending all {} x {} x {} texels", dims.x, dims.y, dims.z);
  const bool seen = bench.require(name, unchanged.pixels != by_boxes.pixels, "the change is not in the picture");
  if (seen && bench.agree(name, canvas.bytes(), bytes_of(by_boxes.pixels)))
    bench.add_speed_up(name, "CPU-ms", 1e3, bench.time(whole, boxes));

  const TexelBox texels = make_texels(voxmap, box);
  std::vector<Rgba8> copy(texels.normal_opacity.size());
  const Side copied{{}, [&] { std::memcpy(copy.data(), texels.normal_opacity.data(), copy.size() * sizeof(Rgba8)); }};
  const Side uploaded{{}, [&] { canvas.renderer.update(texels); }};
  copied.run();
  uploaded.run();
  canvas.draw();
  const std::string upload_name = "upload of a box of 20^3 over a memcpy of it";
  if (bench.agree(upload_name, bytes_of(texels.normal_opacity), bytes_of(copy)) &&
      bench.agree(upload_name, bytes_of(by_boxes.pixels), canvas.bytes()))
    bench.add_cost(upload_name, "us", 1e6, bench.time(copied, uploaded));
  change.set(false);
}

Status compare_skipping(Bench& bench, const VolumeView& volume, const FrameView& view, const std::string& what, RenderOptions options,
                        const Bars& samples) {
  options.skip_empty = true;
  auto skipping = make_canvas(options, view);
  if (!skipping) return skipping.error();
  options.skip_empty = false;
  auto plain = make_canvas(options, view);
  if (!plain) return plain.error();
  std::uint64_t taken[2] = {};
  for (Canvas* canvas : {&*skipping, &*plain}) {
    canvas->set_volume(volume);
    canvas->draw();
    if (!canvas->fault) return canvas->fault;
    const auto probe = canvas->renderer.probe(view, kSide, kSide);
    if (!probe) return probe.error();
    taken[canvas == &*plain ? 1 : 0] = canvas->renderer.counters().probe_samples;
  }
  const std::string name = what + ": skipping empty space over not";
  if (!bench.agree(name, plain->bytes(), skipping->bytes())) return {};
  bench.add_speed_up(name, "CPU-ms", 1e3, bench.time({{}, [&] { plain->draw(); }}, {{}, [&] { skipping->draw(); }}));
  bench.add_absolute(what + ": samples a frame, skipping", "million", kMega * static_cast<double>(taken[0]), true, samples);
  bench.add_absolute(what + ": samples a frame, not skipping", "million", kMega * static_cast<double>(taken[1]), true);
  return {};
}

/// The patch of the published figures: four times as many voxels as the shipped scene has, steps of a whole voxel, four bisections.
Status compare_skipping_on_fine_patch(Bench& bench) {
  const auto loaded = load_parietal_scene({"volume.spacing_mm=0.1171875"});
  if (!loaded) return loaded.error();
  const LoadedScene& fine = **loaded;
  auto voxmap = Voxmap::create(fine.bone, {});
  if (!voxmap) return voxmap.error();
  const auto approach = make_approach(*fine.bone, fine.scene.approach);
  if (!approach) return approach.error();
  const FrameView view =
      make_frame_view(*fine.scene.display, fine.scene.volume.world_from_bone, approach->bone_from_approach, approach->thickness, false);
  const Vec3i dims = fine.bone->dims();
  return compare_skipping(bench, make_volume_view(*voxmap), view, fmt::format("patch of {} x {} x {}, step 1", dims.x, dims.y, dims.z),
                          {.step_voxels = 1.0, .bisections = 4, .finish = false}, {2.0, 1.0});
}

}  // namespace

Status bench_render(Bench& bench) {
  auto drilled = drill_parietal_half_way(bench.quick());
  if (!drilled) return drilled.error();
  const Scene& scene = drilled->loaded->scene;
  Voxmap& voxmap = drilled->simulation->voxmap();
  const Approach& approach = drilled->simulation->approach();
  const FrameView view = make_frame_view(*scene.display, scene.volume.world_from_bone,
                                         scene.volume.world_from_bone * approach.bone_from_approach, approach.thickness, false);
  auto canvas = make_canvas({}, view);
  if (!canvas) return canvas.error();
  // The rim of a hole of 14 mm, on the far side, where the camera sees its wall; low enough for the box to lie inside the volume.
  const Vec3 rim = voxmap.bone().bone_from_index().inverse() * (approach.bone_from_approach * Vec3(0.0, 7e-3, -0.75e-3));
  const VoxelBox box{voxel_of(rim) - 10, voxel_of(rim) + 10};
  if (Status placed = voxmap.place_window(box.grown(4)); !placed) return placed;
  compare_dirty_frame(bench, *canvas, voxmap, box);
  if (!canvas->fault) return canvas->fault;
  if (Status done = compare_skipping(bench, make_volume_view(voxmap), view, "shipped scene half way", {}, {}); !done) return done;
  if (Status done = compare_with_vtk(bench); !done) return done;
  return bench.quick() ? Status{} : compare_skipping_on_fine_patch(bench);
}

}  // namespace burrhole
