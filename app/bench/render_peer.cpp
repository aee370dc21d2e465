#include "app/bench/render_peer.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/bench/bench_scene.h"
#include "app/bench/render_canvas.h"
#include "app/render/renderer.h"
#include "app/report/file.h"
#include "app/report/scratch_folder.h"
#include "app/view/display_config.h"
#include "app/view/texels.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr int kBoxEdge = 20;  // [voxels] edge of the box that changes in a frame of drilling
const std::string kScript = BH_APP_DIR "/../scripts/peers/vtk_peer.py";

/// The bone of the published figures, for both renderers.
struct PeerScene {
  std::unique_ptr<LoadedScene> loaded;
  std::unique_ptr<Voxmap> voxmap;
  VolumeView volume;
  FrameView view;
  VoxelBox box;  ///< changes from frame to frame: in the outer table, at the centre of the picture
};

Result<PeerScene> make_peer_scene() {
  auto loaded = load_parietal_scene({"volume.spacing_mm=0.1171875"});
  if (!loaded) return loaded.error();
  PeerScene out;
  out.loaded = std::move(loaded).value();
  auto voxmap = Voxmap::create(out.loaded->bone, {});
  if (!voxmap) return voxmap.error();
  out.voxmap = std::make_unique<Voxmap>(std::move(voxmap).value());
  const Scene& scene = out.loaded->scene;
  const auto approach = make_approach(*out.loaded->bone, scene.approach);
  if (!approach) return approach.error();
  out.volume = make_volume_view(*out.voxmap);
  out.view = make_frame_view(*scene.find<DisplayConfig>(), Pose{}, approach->bone_from_approach, approach->thickness, false);
  const Vec3 middle = out.loaded->bone->bone_from_index().inverse() * (approach->bone_from_approach * Vec3(0.0, 0.0, -0.5e-3));
  out.box = {voxel_of(middle) - kBoxEdge / 2, voxel_of(middle) + kBoxEdge / 2};
  if (Status placed = out.voxmap->place_window(out.box.grown(4)); !placed) return placed.error();
  return out;
}

/// @returns one density for bone, dura and brain, as our picture shows them.
std::string density_bytes(const VolumeView& volume) {
  std::string out;
  out.reserve(volume.color.size());
  for (std::size_t n = 0; n < volume.color.size(); ++n)
    out.push_back(static_cast<char>(std::max(volume.normal_opacity[n].a, volume.color[n].a)));
  return out;
}

/// @returns the text as one word for the shell.
std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_of(const PeerScene& scene, const fs::path& folder) {
  const Affine& map = scene.volume.bone_from_index;
  const auto mm = [](const Vec3& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x * 1e3, v.y * 1e3, v.z * 1e3); };
  const CameraView& camera = scene.view.camera;
  const Vec3i& dims = scene.volume.dims;
  return fmt::format(
      "{}/usr/bin/python3 {} --raw {} --dims {} {} {} --edge-mm {} --origin-mm {} --eye {} --target {} --up {:.9g} {:.9g} {:.9g} --fov-deg "
      "{:.9g} "
      "--size {} {} --box {} {} {} {} --picture {} 2>{}",
      std::getenv("DISPLAY") != nullptr ? "" : "xvfb-run -a -s '-screen 0 800x800x24' ", quoted(kScript),
      quoted((folder / "density.raw").string()), dims.x, dims.y, dims.z, mm(Vec3(map.linear[0].x, map.linear[1].y, map.linear[2].z)),
      mm(map.offset), mm(camera.eye), mm(camera.target), camera.up.x, camera.up.y, camera.up.z, camera.vertical_fov / kDegree, kCanvasSide,
      kCanvasSide, scene.box.lo.x, scene.box.lo.y, scene.box.lo.z, kBoxEdge, quoted((folder / "vtk.ppm").string()),
      quoted((folder / "stderr.txt").string()));
}

struct PeerRow {
  std::string name;
  double frame = 0.0, after_change = 0.0;  ///< [s] of CPU time, all threads
  std::vector<std::uint8_t> covered;       ///< 1 for each pixel that shows bone
};

/// Runs the peer. @returns nothing if it cannot run; the reason goes to stderr.
Result<std::optional<PeerRow>> run_peer(const PeerScene& scene) {
  const ScratchFolder scratch;
  if (scratch.path().empty()) return bad_input("no temporary folder can be made", fs::temp_directory_path().string());
  if (Status written = write_file((scratch.path() / "density.raw").string(), density_bytes(scene.volume)); !written) return written.error();
  std::FILE* pipe = popen(command_of(scene, scratch.path()).c_str(), "r");
  if (pipe == nullptr) return Error{ErrorCode::internal, "the VTK peer cannot be started", {}};
  std::string output;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output.push_back(static_cast<char>(c));
  const int status = pclose(pipe);
  const auto messages = read_file((scratch.path() / "stderr.txt").string());
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::istringstream lines(messages ? *messages : std::string());
    std::string line, last = "no reason was given";
    while (std::getline(lines, line))
      if (!line.empty()) last = line;
    fmt::print(stderr, "bench: render: no comparison with VTK: {}\n", last);
    return std::optional<PeerRow>();
  }
  const auto json = nlohmann::json::parse(output, nullptr, false);
  if (json.is_discarded()) return Error{ErrorCode::internal, "the VTK peer does not print JSON", kScript};
  PeerRow out{json.at("peer").get<std::string>(),
              1e-3 * json.at("frame").at("cpu_ms").get<double>(),
              1e-3 * json.at("frame_after_change").at("cpu_ms").get<double>(),
              {}};
  const auto picture = read_file((scratch.path() / "vtk.ppm").string());
  constexpr std::size_t kBytes = std::size_t{3} * kCanvasSide * kCanvasSide;
  if (!picture || picture->size() < kBytes) return Error{ErrorCode::internal, "the VTK peer drew no picture", kScript};
  const std::string_view pixels = std::string_view(*picture).substr(picture->size() - kBytes);
  // The background is pure blue. At the faces of the volume there is no gradient and no light, so bone is black there.
  for (std::size_t n = 0; n < kBytes; n += 3) out.covered.push_back(static_cast<std::uint8_t>(pixels[n + 2]) < 230 ? 1 : 0);
  return std::optional(std::move(out));
}

Result<Canvas> make_canvas(const RenderOptions& options, const PeerScene& scene) {
  auto canvas = Canvas::create(options, scene.view);
  if (!canvas) return canvas.error();
  canvas->set_volume(scene.volume);
  if (!canvas->error) return canvas->error.error();
  return canvas;
}

/// @returns the share of pixels that show bone in both pictures or in neither.
Result<double> silhouettes_agree(Canvas& canvas, const PeerRow& peer) {
  const auto probe = canvas.renderer.probe(canvas.view, kCanvasSide, kCanvasSide);
  if (!probe) return probe.error();
  std::size_t same = 0;
  for (std::size_t n = 0; n < peer.covered.size(); ++n) same += peer.covered[n] == probe->hit[n] ? 1u : 0u;
  return static_cast<double>(same) / static_cast<double>(peer.covered.size());
}

/// @returns a side that removes a box of bone or restores it, untimed, and then updates and draws, as a frame of drilling does.
Side drill_frame(Canvas& canvas, PeerScene& scene, std::size_t listener, std::vector<float>& kept, bool& removed) {
  Voxmap& voxmap = *scene.voxmap;
  const VoxelBox box = scene.box;
  voxmap.read_remaining(box, kept);
  return {[&voxmap, &kept, &removed, box] {
            removed = !removed;
            for_each_voxel(box, [&](const Vec3i& v) {
              voxmap.remaining()[voxmap.window().box.offset_of(v)] = removed ? 0.0f : kept[box.offset_of(v)];
            });
            voxmap.commit(box);
          },
          [&voxmap, &canvas, listener] {
            for (const VoxelBox& dirty : voxmap.take_dirty(listener)) canvas.renderer.update(make_texels(voxmap, dirty));
            canvas.draw();
          }};
}

}  // namespace

Status compare_with_vtk(Bench& bench) {
  if (bench.quick()) return {};
  auto scene = make_peer_scene();
  if (!scene) return scene.error();
  const auto found = run_peer(*scene);
  if (!found) return found.error();
  if (!*found) return {};
  const PeerRow& peer = **found;

  RenderOptions options{.step_voxels = 1.0, .bisections = 4, .finish = false, .growth_is_reported = true};
  auto drilled = make_canvas(options, *scene);
  if (!drilled) return drilled.error();
  options.keep_picture = false;
  auto first_hit = make_canvas(options, *scene);
  if (!first_hit) return first_hit.error();
  options.translucent = density_as_opacity(scene->volume.bone_from_index.mean_edge());
  auto compositing = make_canvas(options, *scene);
  if (!compositing) return compositing.error();
  const auto agreement = silhouettes_agree(*first_hit, peer);
  if (!agreement) return agreement.error();
  const Vec3i& dims = scene->volume.dims;
  const std::string over = fmt::format(" over {}'s fixed-point ray caster, {} x {} x {}", peer.name, dims.x, dims.y, dims.z);
  // VTK also draws density below 0.5, so its silhouette is larger by a voxel, here about a pixel.
  if (!bench.require("first hit" + over, *agreement > 0.97,
                     fmt::format("silhouettes agree at {:.1f} % of the pixels only", 100.0 * *agreement)))
    return {};

  const Medians ours = bench.time({{}, [&] { first_hit->draw(); }}, {{}, [&] { compositing->draw(); }});
  bench.add_cost("first hit, 4 bisections" + over, "CPU-ms", 1e3, {peer.frame, ours.baseline}, {0.25, 0.12});
  bench.add_cost("compositing" + over, "CPU-ms", 1e3, {peer.frame, ours.value}, {0.36, 0.20});

  const std::size_t listener = scene->voxmap->add_listener();
  std::vector<float> kept(scene->box.count());
  bool removed = false;
  const Side frame = drill_frame(*drilled, *scene, listener, kept, removed);
  drilled->draw();
  const Medians frames = bench.time({{}, [&] { compositing->draw(); }}, frame);
  bench.add_cost("first hit, frame after a change of 20^3" + over, "CPU-ms", 1e3, {peer.after_change, frames.value},
                 {1.0 / 150.0, 1.0 / 400.0});
  for (const Canvas* canvas : {&*drilled, &*first_hit, &*compositing})
    if (!canvas->error) return canvas->error;
  return {};
}

}  // namespace burrhole
