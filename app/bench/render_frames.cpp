#include "app/bench/render_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "app/render/renderer.h"
#include "app/report/csv.h"

namespace burrhole {
namespace {

constexpr double kEdge = 0.03;  // [m] of the cube that the patch fills

constexpr int kChangedEdge = 20;  // [voxels] of the cube that a change sends

/// A curved plate of bone with a pit, in a cube of voxels.
struct Patch {
  int voxels = 0;  // along each edge
  VolumeView view;
  TexelBox shallow, deeper;  // the cube round the bottom of the pit: as in `view`, and with the pit one voxel deeper
};

/// @param pit [m] height of the pit's centre.
Rgba8 patch_texel(const Vec3& p, double pit, double voxel) {
  const Vec3 middle(0.0, 0.0, -0.055), hollow(0.0, 0.0, pit);
  constexpr double kOuter = 0.065, kInner = 0.058, kPit = 0.004;  // [m]
  const double r = glm::length(p - middle), hole = glm::length(p - hollow);
  // Distances to the two surfaces of the plate and to the pit; the normal is that of the nearest one.
  const double walls[3] = {kOuter - r, r - kInner, hole - kPit};
  const auto nearest = std::min_element(walls, walls + 3) - walls;
  const Vec3 away = nearest == 2 ? (hollow - p) / std::max(hole, 1e-9) : (p - middle) / r * (nearest == 0 ? 1.0 : -1.0);
  return encode_normal(away, static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(0.5 + 0.5 * walls[nearest] / voxel, 0.0, 1.0))));
}

Patch make_patch(int voxels) {
  constexpr double kPitHeight = 0.011, kPitBottom = 0.007;  // [m]
  Patch out{.voxels = voxels, .view = {}, .shallow = {}, .deeper = {}};
  const double voxel = kEdge / voxels;
  out.view.dims = Vec3i(voxels);
  out.view.bone_from_index = Affine::scaling(voxel, Vec3(-0.5 * (kEdge - voxel)));
  const auto texel = [&](const Vec3i& v, double pit) { return patch_texel(out.view.bone_from_index * Vec3(v), pit, voxel); };
  const VoxelBox box{Vec3i(0), out.view.dims};
  out.view.normal_opacity.reserve(box.count());
  for_each_voxel(box, [&](const Vec3i& v) { out.view.normal_opacity.push_back(texel(v, kPitHeight)); });
  out.view.color.assign(box.count(), Rgba8{237, 224, 194, 0});
  const Vec3i bottom(voxels / 2, voxels / 2, static_cast<int>(std::lround((kPitBottom + 0.5 * kEdge) / voxel)));
  const Vec3i lo = bottom - kChangedEdge / 2;
  out.shallow.box = out.deeper.box = {lo, lo + kChangedEdge};
  for_each_voxel(out.shallow.box, [&](const Vec3i& v) {
    for (const auto& [sent, pit] : {std::pair{&out.shallow, kPitHeight}, std::pair{&out.deeper, kPitHeight - voxel}}) {
      sent->normal_opacity.push_back(texel(v, pit));
      sent->field.push_back(field_of(sent->normal_opacity.back().a, 0));
    }
  });
  return out;
}

FrameView view_of_patch() {
  FrameView view;
  view.camera = {.eye = {0.03, -0.045, 0.045}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.6};
  return view;
}

struct FrameTimes {
  double median = 0.0, p99 = 0.0;  // [s]
};

/// Times pictures. @param renderer keeps no picture, so each is drawn completely. @param change is called before each, and timed with it.
Result<FrameTimes> time_frames(Renderer& renderer, const FramesRequest& request, bool quick, const std::function<void(int)>& change) {
  const FrameView view = view_of_patch();
  const double budget = quick ? 0.0 : 5.0;  // [s]
  const std::size_t least = quick ? 2 : 10, most = 500;
  std::vector<double> times;
  double spent = 0.0;
  for (int n = -2; times.size() < least || (spent < budget && times.size() < most); ++n) {  // the first two warm up
    const auto start = std::chrono::steady_clock::now();
    if (change) change(n + 2);
    const auto image = renderer.draw(view, request.width, request.height);
    if (!image) return image.error();
    if (n < 0) continue;
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    spent += times.back();
  }
  std::ranges::sort(times);
  const auto at = [&](double share) { return times[static_cast<std::size_t>(std::lround(share * static_cast<double>(times.size() - 1)))]; };
  return FrameTimes{at(0.5), at(0.99)};
}

/// @returns the rate [Hz] that [AcostaLiu07] gives for its machine, by slices; NaN if it gives none.
double paper_hz(int voxels) { return voxels == 128 ? 304.0 : voxels == 256 ? 41.0 : std::numeric_limits<double>::quiet_NaN(); }

/// Times one method on one patch: the same picture again and again, and a picture after each change.
Status time_method(Bench& bench, const FramesRequest& request, const Patch& patch, const char* method, const RenderOptions& options,
                   CsvTable& table) {
  auto renderer = Renderer::create(options);
  if (!renderer) return renderer.error();
  if (Status set = renderer->set_volume(patch.view); !set) return set;
  const auto still = time_frames(*renderer, request, bench.quick(), nullptr);
  if (!still) return still.error();
  const auto changed = time_frames(*renderer, request, bench.quick(), [&](int n) {
    if (n % 2 != 0) renderer->forget();  // the pit is filled up again
    renderer->update(n % 2 == 0 ? patch.deeper : patch.shallow);
  });
  if (!changed) return changed.error();
  table.add_row({renderer->driver(), method, patch.voxels, request.width, request.height, 1, 1e3 * still->median, 1e3 * still->p99,
                 1.0 / still->median, 1e3 * changed->median, 1e3 * changed->p99, paper_hz(patch.voxels)});
  const std::string what =
      fmt::format("{}, {}^3 at {} x {}, by the clock, {}", method, patch.voxels, request.width, request.height, renderer->driver());
  bench.add_absolute(what, "frames/s", 1.0 / still->median, false);
  bench.add_absolute(what + fmt::format(", after a change of {}^3", kChangedEdge), "frames/s", 1.0 / changed->median, false);
  return {};
}

}  // namespace

Status bench_frames(Bench& bench, const FramesRequest& request) {
  CsvTable table({"driver", "method", "voxels_along_edge", "width", "height", "eyes", "median_ms", "p99_ms", "frames_per_s",
                  "changed_median_ms", "changed_p99_ms", "paper_hz"});
  RenderOptions surface{.step_voxels = 1.0, .bisections = 4, .finish = false, .keep_picture = false, .growth_is_reported = true};
  for (const GlBackend backend : gl_backends())
    if (request.gl == gl_backend_name(backend)) surface.gl = backend;
  RenderOptions translucent = surface, mesh = surface;
  translucent.translucent = TransferFunction{{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 250.0}};
  mesh.mesh = true;
  for (const int voxels : bench.quick() ? std::vector{64} : std::vector{128, 256, 512}) {
    const Patch patch = make_patch(voxels);
    for (const auto& [method, options] :
         {std::pair{"first hit", &surface}, std::pair{"translucent", &translucent}, std::pair{"mesh", &mesh}})
      if (Status done = time_method(bench, request, patch, method, *options, table); !done) return done;
  }
  return table.write(request.csv);
}

}  // namespace burrhole
