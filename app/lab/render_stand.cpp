#include "app/lab/render_stand.h"

#include <time.h>

#include <utility>
#include <vector>

#include "app/lab/cost_row.h"

namespace burrhole {
namespace {

double cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Result<Stand> Stand::create(GlBackend gl, RenderOptions how, const VolumeView& volume, const StandView& view) {
  how.gl = gl;
  how.keep_picture = false;  // each picture is timed completely
  how.appearance.tissue = how.appearance.occlusion = !how.slices && !how.translucent;
  auto renderer = Renderer::create(how);
  if (!renderer) return renderer.error();
  if (Status set = renderer->set_volume(volume); !set) return set.error();
  return Stand(std::move(renderer).value(), view);
}

Result<Image> Stand::draw(const DrawingQuality& quality) {
  if (Status set = renderer_.set_quality(quality); !set) return set.error();
  return renderer_.draw(view_.view, view_.width, view_.height);
}

double Stand::bytes() const { return static_cast<double>(renderer_.counters().volume_bytes + renderer_.counters().skip_map_bytes); }

Result<Drawn> draw_timed(Stand& stand, const DrawingQuality& quality, Stand& shipped, int frames) {
  const auto timed = [](Stand& which, const DrawingQuality& how, std::vector<double>& times) -> Result<Image> {
    const double start = cpu_us();
    auto image = which.draw(how);
    times.push_back(cpu_us() - start);
    return image;
  };
  Drawn out;
  std::vector<double> times, baseline;
  for (const auto& [which, how] : {std::pair{&stand, &quality}, std::pair{&shipped, &kShippedQuality}})
    if (const auto image = which->draw(*how); !image) return image.error();
  for (int n = 0; n < frames; ++n) {
    if (n % 3 == 0)
      if (const auto image = timed(shipped, kShippedQuality, baseline); !image) return image.error();
    auto image = timed(stand, quality, times);
    if (!image) return image.error();
    out.image = std::move(image).value();
  }
  out.median_us = at_share(times, 0.5);
  out.p99_us = at_share(times, 0.99);
  out.over_shipped = out.median_us / at_share(baseline, 0.5);
  return out;
}

}  // namespace burrhole
