#include "app/bench/render_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include "app/render/renderer.h"
#include "app/report/csv.h"

namespace burrhole {
namespace {

constexpr double kEdge = 0.03;  // [m] of the cube that the patch fills

/// @returns a curved plate of bone with a pit. @param voxels along each edge of the cubic volume.
VolumeView make_patch(int voxels) {
  VolumeView out;
  out.dims = Vec3i(voxels);
  const double voxel = kEdge / voxels;
  out.bone_from_index = Affine::scaling(voxel, Vec3(-0.5 * (kEdge - voxel)));
  const VoxelBox box{Vec3i(0), out.dims};
  out.normal_opacity.reserve(box.count());
  const Vec3 middle(0.0, 0.0, -0.055), pit(0.0, 0.0, 0.011);
  constexpr double kOuter = 0.065, kInner = 0.058, kPit = 0.004;  // [m]
  for_each_voxel(box, [&](const Vec3i& v) {
    const Vec3 p = out.bone_from_index * Vec3(v);
    const double r = glm::length(p - middle), hole = glm::length(p - pit);
    // Distances to the two surfaces of the plate and to the pit; the normal is that of the nearest one.
    const double walls[3] = {kOuter - r, r - kInner, hole - kPit};
    const auto nearest = std::min_element(walls, walls + 3) - walls;
    const Vec3 away = nearest == 2 ? (pit - p) / std::max(hole, 1e-9) : (p - middle) / r * (nearest == 0 ? 1.0 : -1.0);
    out.normal_opacity.push_back(
        encode_normal(away, static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(0.5 + 0.5 * walls[nearest] / voxel, 0.0, 1.0)))));
  });
  out.color.assign(out.normal_opacity.size(), Rgba8{237, 224, 194, 0});
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

/// Times pictures. @param renderer keeps no picture, so each is drawn completely.
Result<FrameTimes> time_frames(Renderer& renderer, const FramesRequest& request, bool quick) {
  const FrameView view = view_of_patch();
  const double budget = quick ? 0.0 : 5.0;  // [s]
  const std::size_t least = quick ? 2 : 10, most = 500;
  std::vector<double> times;
  double spent = 0.0;
  for (int n = -2; times.size() < least || (spent < budget && times.size() < most); ++n) {  // the first two warm up
    const auto start = std::chrono::steady_clock::now();
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

}  // namespace

Status bench_frames(Bench& bench, const FramesRequest& request) {
  CsvTable table({"driver", "method", "voxels_along_edge", "width", "height", "eyes", "median_ms", "p99_ms", "frames_per_s", "paper_hz"});
  RenderOptions surface{.step_voxels = 1.0, .bisections = 4, .finish = false, .keep_picture = false};
  for (const GlBackend backend : gl_backends())
    if (request.gl == gl_backend_name(backend)) surface.gl = backend;
  RenderOptions translucent = surface;
  translucent.translucent = TransferFunction{{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 250.0}};
  for (const int voxels : bench.quick() ? std::vector{64} : std::vector{128, 256, 512}) {
    const VolumeView patch = make_patch(voxels);
    for (const auto& [method, options] : {std::pair{"first hit", &surface}, std::pair{"translucent", &translucent}}) {
      auto renderer = Renderer::create(*options);
      if (!renderer) return renderer.error();
      if (Status set = renderer->set_volume(patch); !set) return set;
      const auto times = time_frames(*renderer, request, bench.quick());
      if (!times) return times.error();
      table.add_row({renderer->driver(), method, voxels, request.width, request.height, 1, 1e3 * times->median, 1e3 * times->p99,
                     1.0 / times->median, paper_hz(voxels)});
      bench.add_absolute(
          fmt::format("{}, {}^3 at {} x {}, by the clock, {}", method, voxels, request.width, request.height, renderer->driver()),
          "frames/s", 1.0 / times->median, false);
    }
  }
  return table.write(request.csv);
}

}  // namespace burrhole
