#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "app/bench/render_canvas.h"
#include "app/render/shader_source.h"
#include "app/report/scratch_folder.h"

namespace burrhole {
namespace {

constexpr double kMega = 1e-6;

/// The scene of all rows of one call.
struct Subject {
  const VolumeView& volume;
  const FrameView& view;
  const std::string& what;
};

/// Surface and translucent bone as in the published figures: steps of one voxel, no finish.
const RenderOptions kSurface{.step_voxels = 1.0, .bisections = 4, .finish = false, .keep_picture = false};
RenderOptions translucent(TransferFunction transfer) {
  RenderOptions options = kSurface;
  options.translucent = std::move(transfer);
  return options;
}

Result<Canvas> make_drawn(const Subject& subject, const RenderOptions& options) {
  auto canvas = Canvas::create(options, subject.view);
  if (!canvas) return canvas.error();
  canvas->set_volume(subject.volume);
  canvas->draw();
  if (!canvas->error) return canvas->error.error();
  return canvas;
}

Medians time_drawing(Bench& bench, Canvas& baseline, Canvas& value) {
  return bench.time({{}, [&] { baseline.draw(); }}, {{}, [&] { value.draw(); }});
}

Result<double> million_samples(Canvas& canvas) {
  const auto probe = canvas.renderer.probe(canvas.view, kCanvasSide, kCanvasSide);
  if (!probe) return probe.error();
  return kMega * static_cast<double>(canvas.renderer.counters().probe_samples);
}

Status compare_skipping(Bench& bench, const Subject& subject, const std::string& way, RenderOptions options, const Bars& bars) {
  options.skip_empty = true;
  auto skipping = make_drawn(subject, options);
  if (!skipping) return skipping.error();
  options.skip_empty = false;
  auto plain = make_drawn(subject, options);
  if (!plain) return plain.error();
  const auto few = million_samples(*skipping), many = million_samples(*plain);
  if (!few || !many) return (few ? many : few).error();
  const std::string name = fmt::format("{}, {}: skipping empty space over not", subject.what, way);
  if (!bench.agree(name, plain->bytes(), skipping->bytes())) return {};
  const Medians medians = time_drawing(bench, *plain, *skipping);
  bench.add_speed_up(name, "CPU-ms", 1e3, medians);
  bench.add_absolute(fmt::format("{}, {}: whole frame", subject.what, way), "CPU-ms", 1e3 * medians.value, true);
  bench.add_absolute(fmt::format("{}, {}: samples a frame, skipping", subject.what, way), "million", *few, true, bars);
  bench.add_absolute(fmt::format("{}, {}: samples a frame, not skipping", subject.what, way), "million", *many, true);
  return {};
}

/// Writes the shaders with a shading function that returns the tissue's colour.
void write_unshaded(const std::filesystem::path& folder) {
  constexpr std::string_view kUnshaded =
      "vec3 shade(vec3 p, vec3 world, vec3 normal, vec3 to_eye, bool is_face) {\n"
      "  return textureLod(color_soft, texture_from_index(p), 0.0).rgb;\n"
      "}\n";
  for (const auto& [file, text] : embedded_shaders()) std::ofstream(folder / file) << (file == "shade.glsl" ? kUnshaded : text);
}

Status compare_shading(Bench& bench, const Subject& subject, const std::string& way, RenderOptions options, const Bars& bars) {
  const ScratchFolder folder;
  if (folder.path().empty()) return Error{ErrorCode::internal, "no folder can be created for shaders", {}};
  write_unshaded(folder.path());
  auto shaded = make_drawn(subject, options);
  if (!shaded) return shaded.error();
  options.shader_folder = folder.path();
  auto unshaded = make_drawn(subject, options);
  if (!unshaded) return unshaded.error();
  // The rays must be the same: equal numbers of samples.
  const auto lit = shaded->renderer.probe(subject.view, kCanvasSide, kCanvasSide);
  const auto dark = unshaded->renderer.probe(subject.view, kCanvasSide, kCanvasSide);
  if (!lit || !dark) return (lit ? dark : lit).error();
  const std::string name = fmt::format("{}, {}: shaded over unshaded", subject.what, way);
  if (bench.agree(name, bytes_of(dark->samples), bytes_of(lit->samples)) &&
      bench.require(name, shaded->image.pixels != unshaded->image.pixels, "both are lit alike"))
    bench.add_cost(name, "CPU-ms", 1e3, time_drawing(bench, *unshaded, *shaded), bars);
  return {};
}

/// @returns the mean difference of brightness [levels].
double mean_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.pixels.size(); ++n) sum += std::abs(int{a.pixels[n].g} - int{b.pixels[n].g});
  return sum / static_cast<double>(a.pixels.size());
}

/// Times rays; the baseline is slices, both with a distance of one voxel. Slices have soft edges, so the pictures are similar, not equal.
Status compare_slices(Bench& bench, const Subject& subject) {
  RenderOptions by_slices = kSurface;
  by_slices.slices = SliceOptions{};
  auto slices = make_drawn(subject, by_slices);
  if (!slices) return slices.error();
  auto rays = make_drawn(subject, kSurface);
  if (!rays) return rays.error();
  auto nothing = Canvas::create(kSurface, subject.view);
  if (!nothing) return nothing.error();
  nothing->draw();
  const std::string name = subject.what + ": rays over slices";
  // The two pictures must differ by less than an eighth of the difference between the picture and the background.
  const double apart = mean_difference(rays->image, slices->image), seen = mean_difference(rays->image, nothing->image);
  const std::vector<std::uint8_t> one{1}, is_one_scene{static_cast<std::uint8_t>(8.0 * apart < seen ? 1 : 0)};
  if (bench.agree(name, bytes_of(one), bytes_of(is_one_scene)))
    bench.add_speed_up(name, "CPU-ms", 1e3, time_drawing(bench, *slices, *rays), {10.0, {}});
  return {};
}

}  // namespace

TransferFunction density_as_opacity(double edge) {
  TransferFunction out;
  for (int n = 0; n <= 32; ++n) {
    const double density = n / 32.0;
    out.push_back({.density = density, .extinction = -std::log(1.0 - std::min(density, 0.998)) / edge});
  }
  return out;
}

Status compare_rays(Bench& bench, const VolumeView& volume, const FrameView& view, const std::string& what, const Bars& surface_samples,
                    const Bars& translucent_samples) {
  const Subject subject{volume, view, what};
  if (Status done = compare_skipping(bench, subject, "surface", kSurface, surface_samples); !done) return done;
  const RenderOptions opaque = translucent(density_as_opacity(volume.bone_from_index.mean_edge()));
  if (Status done = compare_skipping(bench, subject, "compositing", opaque, translucent_samples); !done) return done;
  // The translucent bone of `shading = "translucent"`: rays pass through all of it, so there is little to skip.
  const RenderOptions haze = translucent({{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 250.0}});
  if (Status done = compare_skipping(bench, subject, "thin haze", haze, {}); !done) return done;
  if (Status done = compare_shading(bench, subject, "surface", kSurface, {1.08, 1.015}); !done) return done;
  if (Status done = compare_shading(bench, subject, "compositing", opaque, {1.2, 1.015}); !done) return done;
  return compare_slices(bench, subject);
}

}  // namespace burrhole
